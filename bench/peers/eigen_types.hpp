// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCore>

#include "bench/peers/matrix_peer.hpp"

namespace sunder::bench {

using Lower = Eigen::SparseMatrix<double>;

inline Lower copy_of(const LowerTriangle& m) {
  return Eigen::Map<const Lower>(m.n, m.n, static_cast<Eigen::Index>(m.values.size()),
                                 m.outer.data(), m.inner.data(), m.values.data());
}

inline Eigen::Map<const Eigen::VectorXd> vector_of(std::span<const double> v) {
  return {v.data(), static_cast<Eigen::Index>(v.size())};
}

inline Eigen::Map<Eigen::VectorXd> vector_of(std::span<double> v) {
  return {v.data(), static_cast<Eigen::Index>(v.size())};
}

}  // namespace sunder::bench
