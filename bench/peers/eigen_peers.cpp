// SPDX-License-Identifier: Apache-2.0
#include "bench/cholmod_data.hpp"
#include "bench/peers/matrix_peer.hpp"
#include "bench/peers/peer.hpp"

namespace sunder::bench {
namespace {

/// Gives a peer of matrices the board's matrix after every event.
class Assembled : public Peer {
 public:
  Assembled(const TearingBoard& board, std::unique_ptr<MatrixPeer> peer)
      : board_(board), peer_(std::move(peer)), f_(load_vector(board)) {
    prepare({});
    update();
  }
  void prepare(std::span<const Index> elements) override {
    destroyed_.insert(destroyed_.end(), elements.begin(), elements.end());
    const linear_algebra::SparseMatrix k = damaged_stiffness(*board_.problem, destroyed_);
    const auto entries = static_cast<std::size_t>(k.nonZeros());
    peer_->set_matrix({static_cast<int>(k.rows()),
                       {k.outerIndexPtr(), static_cast<std::size_t>(k.cols()) + 1},
                       {k.innerIndexPtr(), entries},
                       {k.valuePtr(), entries}});
  }
  void update() override { peer_->update(); }
  void solve(std::span<double> u) override {
    peer_->solve({f_.data(), static_cast<std::size_t>(f_.size())}, u);
  }
  std::size_t bytes() const override { return peer_->bytes(); }

 private:
  const TearingBoard& board_;
  std::unique_ptr<MatrixPeer> peer_;
  Eigen::VectorXd f_;
  std::vector<Index> destroyed_;
};

}  // namespace

std::vector<PeerKind> eigen_peers() {
  std::vector<PeerKind> all;
  for (const auto& kinds : {dense_peers(), sparse_peers()}) {
    for (const MatrixPeerKind& kind : kinds) {
      all.push_back({kind.name, kind.settings, kind.most_tets,
                     [create = kind.create](const TearingBoard& board) {
                       return std::make_unique<Assembled>(board, create());
                     }});
    }
  }
  return all;
}

}  // namespace sunder::bench
