// SPDX-License-Identifier: Apache-2.0
// The promise of a condensed frame at the price of what the frame changed. A full check applies the
// inverse to the whole residual. What the base gives wrong is linear in the load: once the loads of
// full checks span a load's direction, their errors bound that of the base. Damage can only spoil
// the solution where it acts, and the energy of what the deferred update lacks there bounds the
// stress that it misses.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "solver/base_check.hpp"

namespace sunder::solver {

class EnergyCheck {
 public:
  explicit EnergyCheck(const Problem& problem);

  /// What the loads of full checks let expect of another one: bounds, each a sum over their shares.
  struct Expected {
    double largest_u = 0;   // [mm]
    double largest = 0;     // stress over live elements [MPa]
    double base_error = 0;  // [MPa] by the base itself
    double worst = 0;       // of the relative errors of their bases
    bool alone = false;     // the load is a multiple of the last full check's
  };

  /// Takes what a full check said of a load, and the error before it refined the solution: that is
  /// what the base gives by itself. `largest`: the largest stress over live elements.
  void checked(const Load& load, const SolveReport& report, double unrefined, int bases,
               double largest_u, double largest);
  /// Nothing is known any more: the loads to come are of other grips.
  void forget() {
    checks_.clear();
    bases_ = 0;
    changed_ = true;
  }
  /// Takes what is known of a base that is new since the last full check.
  void follow(int bases, const BaseCheck& check);
  /// Whether what this knows is of loads on the same unknowns.
  [[nodiscard]] bool takes(const Load& load, int) const { return on_same_unknowns(load); }
  /// Nothing: the load needs a full check.
  [[nodiscard]] std::optional<Expected> expected(const Load& load, int bases);
  /// An event has changed the body.
  void event() { changed_ = true; }

  /// Energy [N mm] of a defect that needs no refinement.
  [[nodiscard]] double energy_tolerance(const Expected& expected) const;
  /// What is known of a solution without a full check; nothing when that is needed. `energy`: of
  /// what the deferred update lacked (Deferred::defect_energy).
  [[nodiscard]] std::optional<SolveReport> known(const Expected& expected, double energy,
                                                 double largest_u, double largest) const;

 private:
  struct Checked {
    Load load;
    double unrefined = 0;  // error of the base by itself
    double largest_u = 0, largest = 0;
  };
  /// A few of them; what one held keeps its room for the next.
  class Directions {
   public:
    static constexpr std::size_t kMost = 6;
    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] bool empty() const { return size_ == 0; }
    [[nodiscard]] const Checked& operator[](std::size_t i) const { return slots_[i]; }
    void reserve(const Problem& problem);
    void clear() { size_ = 0; }
    void push_back(const Checked& checked) { slots_[size_++] = checked; }
    void swap(Directions& other) {
      slots_.swap(other.slots_);
      std::swap(size_, other.size_);
    }

   private:
    std::array<Checked, kMost> slots_;
    std::size_t size_ = 0;
  };
  void add_direction(const Checked& checked);
  void take_direction(const Checked& checked);
  using Column = Eigen::Map<Eigen::VectorXd>;
  [[nodiscard]] Column column(std::vector<double>& of, Eigen::Index i = 0) const;
  void write(const Load& load);
  [[nodiscard]] double beyond_span(std::size_t directions);
  [[nodiscard]] bool shares_of(const Load& load);
  [[nodiscard]] bool on_same_unknowns(const Load& load) const;

  const Problem& problem_;
  double stress_of_energy_;  // sqrt of the largest stress^2 per energy over all elements
  SolveReport report_;       // of the last full check
  Checked next_;             // the check in work
  Directions checks_;        // the last one first, none in the span of those before it
  Directions others_;        // those before it, as they are sorted in
  // Their loads as columns of rows_ entries, each by its unit: Q R.
  std::vector<double> q_;
  Eigen::MatrixXd r_;
  double force_unit_ = 1, displacement_unit_ = 1;
  Eigen::Index rows_ = 0;
  std::vector<double> v_;  // a load
  /// Its shares of checks_; its room does not follow its size.
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, Directions::kMost, 1> shares_;
  int bases_ = 0;        // of the last full check; 0: there was none
  bool changed_ = true;  // since the last full check
};

}  // namespace sunder::solver
