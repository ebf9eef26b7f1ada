// SPDX-License-Identifier: Apache-2.0
// What is looked at: a body as it was prepared, what is done to it, and how it is shown.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/inputs/hand.hpp"
#include "app/view/shown.hpp"

namespace sunder::app {

/// Where a body is from: a scene or a mesh, and what a view has changed of its scene since.
struct Origin {
  std::filesystem::path file;
  std::vector<std::string> changes;  ///< "KEY.PATH=VALUE" as --set takes it, each key once
};

/// Changes, then others: a key that comes again takes the place of what it was.
[[nodiscard]] std::vector<std::string> changed(std::vector<std::string> before,
                                               const std::vector<std::string>& then);

struct BodyPlan {
  std::shared_ptr<const Problem> problem;
  Simulation::MakeBackend make;
  std::vector<std::string> warnings;  ///< of reading
  /// What `make` tells of backends on the device that draws; null: it makes none.
  std::shared_ptr<view::SharedPoints> points = nullptr;
};
/// Reads an origin. Throws InputError where it cannot be read or is wrong.
using PlanBody = std::function<BodyPlan(const Origin&)>;

struct Body {
  /// `make`: the backend, once and, `goes_back`, whenever going back takes a new one. Prepares it.
  /// `shared`: as BodyPlan::points.
  Body(const std::shared_ptr<const Problem>& problem, const Simulation::MakeBackend& make,
       bool goes_back, std::shared_ptr<view::SharedPoints> shared = nullptr);
  Body(const Body&) = delete;
  Body& operator=(const Body&) = delete;

  /// A step, if there is one left.
  void step();
  /// Of the last step, as far back as one has gone; null before the first.
  [[nodiscard]] const StepReport* report() const;

  Simulation simulation;
  Hand hand;
  Showing showing;
  std::vector<Vec3> points;  ///< that pictures have room for (shown_points)

 private:
  std::vector<StepReport> reports_;  ///< by step
};

/// Whether what is prepared for a body serves the other one too: the intact stiffness is the same,
/// by law linear, at rest, on the processors, on the same route.
[[nodiscard]] bool same_base(const Body& a, const Body& b);

}  // namespace sunder::app
