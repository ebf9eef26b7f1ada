// SPDX-License-Identifier: Apache-2.0
// Peers that need nothing but the assembled matrix. They are compiled with -march=native, where
// Eigen's own memory is aligned otherwise than in the rest of the program: no Eigen type may pass
// this interface, and nothing of Sunder is linked behind it.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace sunder::bench {

/// Lower triangle by columns; views into the caller's memory.
struct LowerTriangle {
  int n = 0;
  std::span<const int> outer, inner;
  std::span<const double> values;
};

class __attribute__((visibility("default"))) MatrixPeer {
 public:
  virtual ~MatrixPeer() = default;
  /// Untimed. The pattern never changes.
  virtual void set_matrix(const LowerTriangle& lower) = 0;
  virtual void update() = 0;
  virtual void solve(std::span<const double> f, std::span<double> u) = 0;
  [[nodiscard]] virtual std::size_t bytes() const = 0;
};

struct MatrixPeerKind {
  std::string name, settings;
  int most_tets = 0;  ///< as PeerKind's
  std::function<std::unique_ptr<MatrixPeer>()> create;
};

/// Dense inverses anew by OpenBLAS and Eigen; Eigen's sparse solvers.
[[nodiscard]] __attribute__((visibility("default"))) std::vector<MatrixPeerKind> dense_peers();
[[nodiscard]] __attribute__((visibility("default"))) std::vector<MatrixPeerKind> sparse_peers();

}  // namespace sunder::bench
