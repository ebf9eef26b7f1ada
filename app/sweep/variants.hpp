// SPDX-License-Identifier: Apache-2.0
// The problems of a sweep: one scene with other values in it, its meshes read once each.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "app/sweep/axes.hpp"
#include "sunder/problem.hpp"

namespace sunder::app::sweep {

class Variants {
 public:
  /// `overrides` are those of --set and its kin. Throws InputError.
  Variants(std::filesystem::path scene, std::vector<std::string> overrides, std::vector<Axis> axes);

  /// By any number of threads. Throws InputError.
  [[nodiscard]] std::shared_ptr<const Problem> problem(const std::vector<std::size_t>& places);
  /// Reads the scene alone, without its mesh. Throws InputError.
  void read(const std::vector<std::size_t>& places) const;

  [[nodiscard]] const std::vector<Axis>& axes() const { return axes_; }
  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] const std::vector<std::string>& overrides() const { return overrides_; }
  /// Of reading the meshes so far.
  [[nodiscard]] std::vector<std::string> warnings() const;
  /// Of each mesh so far, its path and a number that another mesh hardly has.
  [[nodiscard]] std::vector<std::string> fingerprints() const;

 private:
  std::shared_ptr<const Mesh> mesh(const std::string& path);

  std::filesystem::path scene_;
  std::vector<std::string> overrides_;
  std::vector<Axis> axes_;
  std::string text_;
  mutable std::mutex mutex_;
  std::map<std::string, std::shared_ptr<const Mesh>> meshes_;  // by path, as written
  std::vector<std::string> warnings_;
};

/// What is found before the first run.
struct Checked {
  std::vector<bool> changes_body;  ///< per axis: whether its values change the stiffness
  int instruments = 0;             ///< the most of any value
  std::shared_ptr<const Problem> first;
};

/// Looks at each value by itself, the other axes at their first one. Throws InputError, as the run
/// would; and DeviceError where the scene asks for a backend that no sweep has.
[[nodiscard]] Checked check_values(Variants& variants);

}  // namespace sunder::app::sweep
