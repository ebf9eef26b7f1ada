// SPDX-License-Identifier: Apache-2.0
// What full checks of a base have found of some loads, and others as sums of those. Solutions are
// linear in the load: once the loads of full checks span what the hands of a scene can do, a frame
// needs none however they wander.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "solver/base_check.hpp"

namespace sunder::solver {

class CheckedLoads {
 public:
  /// Two hands that shift and turn.
  static constexpr std::size_t kMost = 12;

  /// The problem's largest load finds room: whatever its direction, a frame allocates nothing.
  explicit CheckedLoads(const Problem& problem);

  /// Of a load's solution.
  struct Found {
    double error = 0;               ///< of stress, relative, before the solution was refined
    double stress_of_residual = 0;  ///< that a residual of 1 N is worth [MPa]
    double largest_u = 0;           ///< [mm]
    double largest_stress = 0;      ///< over live elements [MPa]
    double forces = 0;              ///< of damage (Deferred::forces); 0: unknown
    int events = 0;                 ///< that have changed the body since
  };
  /// Takes what a full check has found, on the base of that number (from 1), before what others
  /// have: of them those stay that are of that base and add most to what all span.
  void checked(const Load& load, const Found& found, int bases);
  /// Takes what is known of a base that is new since the last full check; false: nothing of use.
  bool follow(int bases, const BaseCheck& check);
  /// An event has changed the body.
  void event();
  /// Other grips hold it: nothing is known.
  void forget() { bases_ = 0; }
  /// Whether the loads known are on the same unknowns.
  [[nodiscard]] bool takes(const Load& load) const;

  /// A load as a sum of those known.
  struct Sum {
    double largest_u = 0, largest_stress = 0;  ///< at most, by the shares
    double stress_error = 0;                   ///< at most, by the shares [MPa]
    double error = 0, stress_of_residual = 0;  ///< the largest of those that it is made of
    double forces = 0;                         ///< at most, by the shares; 0: one is unknown
    bool alone = false;                        ///< a multiple of the last one checked
    int events = 0;                            ///< since the first of them
    /// No event since any of them.
    [[nodiscard]] bool fresh() const { return events == 0; }
  };
  /// Of a load; nothing: it is no sum of theirs, or the base is one that nothing is known of.
  [[nodiscard]] std::optional<Sum> expected(const Load& load, int bases);

 private:
  using Column = Eigen::Map<Eigen::VectorXd>;
  [[nodiscard]] Column column(std::vector<double>& of, std::size_t i = 0) const;
  void write(const Load& load);
  void begin(const Load& load);
  void bring(std::size_t slot);
  [[nodiscard]] double beyond_span();
  void take(std::size_t slot);
  [[nodiscard]] std::size_t free_slot() const;
  void sort_in(std::size_t newest);
  [[nodiscard]] std::optional<Sum> sum_of(const Load& load);

  std::size_t most_;  // directions that there is room for
  int bases_ = 0;     // of the last full check; 0: there was none
  // The loads known, on these unknowns and so many grips: rows_ entries a slot.
  std::vector<Index> dofs_;
  std::size_t grips_ = 0;
  Eigen::Index rows_ = 0;
  std::vector<double> loads_;
  std::array<Found, kMost> found_;
  std::array<std::size_t, kMost> order_{};  // slots, the last one first
  std::size_t size_ = 0;
  // As columns in that order, none in the span of those before it, each by its unit: Q R.
  std::vector<double> q_;
  Eigen::MatrixXd r_;
  double force_unit_ = 1, displacement_unit_ = 1;
  std::vector<double> v_;  // a load
  /// Its shares of the columns; its room does not follow its size.
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1> shares_;
};

}  // namespace sunder::solver
