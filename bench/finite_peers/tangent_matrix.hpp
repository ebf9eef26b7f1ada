// SPDX-License-Identifier: Apache-2.0
// A sparse matrix that is filled anew from its elements each iteration: where each entry goes is
// found once, as every code that refactorises does.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "body/assembly.hpp"
#include "body/hyperelastic.hpp"
#include "linear_algebra/workers.hpp"

namespace sunder::bench {

class TangentMatrix {
 public:
  enum class Stored { lower, both };

  TangentMatrix(const Problem& problem, Stored stored, int threads)
      : problem_(problem), stored_(stored), workers_(std::make_unique<Workers>(threads)) {
    const linear_algebra::SparseMatrix lower = fem::assemble_elements(
        problem, [](Index) -> fem::ElementMatrix { return fem::ElementMatrix::Ones(); });
    if (stored == Stored::lower) {
      matrix_ = lower;
    } else {
      matrix_ = lower.selfadjointView<Eigen::Lower>();
    }
    matrix_.makeCompressed();
    find_places();
  }

  /// Of live elements, by `of(e)`; unknowns that none of them reaches get a 1. Returns the matrix.
  template <class Of>
  const linear_algebra::SparseMatrix& fill(const fem::HyperelasticBody& body, Of&& of) {
    std::fill_n(matrix_.valuePtr(), matrix_.nonZeros(), 0.0);
    const Index count = problem_.tet_count();
    for (Index first = 0; first < count; first += kChunk) {
      const Index end = std::min(first + kChunk, count);
      workers_->run([&](int worker) {
        for (Index e = first + worker; e < end; e += workers_->count()) {
          if (body.live(e)) of(e, some_[e - first]);
        }
      });
      for (Index e = first; e < end; ++e) {
        if (body.live(e)) add(e, some_[e - first]);
      }
    }
    for (Index d = 0; d < matrix_.cols(); ++d) {
      double& diagonal = matrix_.valuePtr()[diagonal_[d]];
      if (diagonal == 0) diagonal = 1;
    }
    return matrix_;
  }
  [[nodiscard]] const linear_algebra::SparseMatrix& matrix() const { return matrix_; }

 private:
  static constexpr Index kChunk = 512;  // elements whose matrices are made before they are added

  [[nodiscard]] Index place(Index row, Index column) const {
    const Index* begin = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[column];
    const Index* end = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[column + 1];
    return static_cast<Index>(std::lower_bound(begin, end, row) - matrix_.innerIndexPtr());
  }
  void find_places() {
    places_.assign(144 * problem_.mesh().tets.size(), kNone);
    auto to = places_.begin();
    for (const auto& corners : problem_.mesh().tets) {
      for (int j = 0; j < 12; ++j) {
        const Index column = problem_.dof(corners[j / 3], j % 3);
        for (int i = 0; i < 12; ++i, ++to) {
          const Index row = problem_.dof(corners[i / 3], i % 3);
          const bool held = row == kNone || column == kNone;
          if (!held && (stored_ == Stored::both || row >= column)) *to = place(row, column);
        }
      }
    }
    for (Index d = 0; d < matrix_.cols(); ++d) diagonal_.push_back(place(d, d));
  }
  void add(Index e, const fem::ElementMatrix& k) {
    const Index* at = &places_[144 * static_cast<std::size_t>(e)];
    for (int i = 0; i < 144; ++i) {
      if (at[i] != kNone) matrix_.valuePtr()[at[i]] += k.data()[i];
    }
  }

  const Problem& problem_;
  Stored stored_;
  std::unique_ptr<Workers> workers_;
  linear_algebra::SparseMatrix matrix_;
  std::vector<Index> places_, diagonal_;
  std::vector<fem::ElementMatrix> some_{kChunk};
};

}  // namespace sunder::bench
