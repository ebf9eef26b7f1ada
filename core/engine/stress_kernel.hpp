// SPDX-License-Identifier: Apache-2.0
// Element stress, eight elements at a time, with what a frame wants to know of it: the largest
// norm, and a bound of each element's yield ratio.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "engine/workers.hpp"
#include "sunder/backend.hpp"

namespace sunder::engine {

class StressKernel {
 public:
  static constexpr int kLanes = 8;

  /// Over all elements, or over those listed (ascending). `threads` 0: as many as the machine
  /// offers, if there are elements enough to be worth it. The bits do not depend on it.
  StressKernel(std::shared_ptr<const Problem> problem, std::vector<Index> elements, int threads);

  /// Follows the removal of elements: their stress is scaled and no longer counts.
  void destroy(std::span<const Index> elements);

  /// Stress a_e D B u from the displacement at all nodes (3 * nodes), bit by bit that of
  /// fem::stress, one value per listed element in that order; empty `stress`: not stored. Returns
  /// the largest norm of the tensor over live elements; not finite when one of them is not.
  double run(std::span<const double> u, std::span<Voigt> stress);

  /// Worst ratios of the stress that the last run() stored.
  [[nodiscard]] StressSummary summarize(std::span<const std::uint8_t> excluded,
                                        std::span<const Voigt> stress) const;

  /// Where run() puts the stress of an element; kNone: it is not listed.
  [[nodiscard]] Index place(Index element) const { return place_[element]; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] int threads() const { return workers_->count(); }
  /// Makes run() keep what summarize() reads.
  void keep_bounds();
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct alignas(64) Block {
    double gradient[9][kLanes];  // of corners 1..3: 3 * (corner - 1) + axis
    double mu[kLanes], lambda[kLanes];
    double scale[kLanes];     // a_e
    double live[kLanes];      // 1, or 0: does not count
    double strength[kLanes];  // 1 / yield^2 of live breakable elements, else 0
    Index corner[4][kLanes];  // 3 * node
    Index element[kLanes];    // kNone: filler
  };
  struct Partial {
    double largest = 0, check = 0;
  };
  static void run_blocks(const Block* blocks, std::size_t count, const double* u, Voigt* stress,
                         double* bounds, Partial& partial);
  [[nodiscard]] Worst worst(std::span<const std::uint8_t> excluded,
                            std::span<const Voigt> stress) const;

  std::shared_ptr<const Problem> problem_;
  std::size_t size_ = 0;  // listed elements
  std::vector<Block> blocks_;
  std::vector<Index> place_;    // of each element, kNone: not in here
  std::vector<double> bounds_;  // J_2 / yield^2 per place
  std::vector<Partial> partials_;
  std::unique_ptr<Workers> workers_;
};

}  // namespace sunder::engine
