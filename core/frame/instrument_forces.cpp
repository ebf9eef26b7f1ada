// SPDX-License-Identifier: Apache-2.0
#include "sunder/instrument_forces.hpp"

#include <algorithm>

#include "sunder/error.hpp"

namespace sunder {

InstrumentForces::InstrumentForces(std::span<const double> anchors)
    : size_(static_cast<Index>(anchors.size())), anchors_(size_) {
  std::copy(anchors.begin(), anchors.end(), anchors_.begin());
  for (Copy& copy : copies_) {
    copy.l.setZero(size_, size_);
    copy.u_0.setZero(size_);
  }
}

void InstrumentForces::publish(const Eigen::Ref<const Eigen::MatrixXd>& l,
                               const Eigen::Ref<const Eigen::VectorXd>& u_0) {
  if (l.rows() != size_ || l.cols() != size_ || u_0.size() != size_) {
    throw UsageError("instrument forces have one row per gripped dof");
  }
  const bool sound =
      u_0.allFinite() && l.diagonal().allFinite() && (l.diagonal().array() > 0).all();
  if (!sound) return;
  Copy& copy = copies_[writing_];
  copy.l = l;
  copy.u_0 = u_0;
  copy.filled = true;
  writing_ = between_.exchange(writing_ | kFresh, std::memory_order_acq_rel) & ~kFresh;
  frames_.fetch_add(1, std::memory_order_relaxed);
}

bool InstrumentForces::forces(std::span<const double> displacements, std::span<double> forces) {
  if (displacements.size() != static_cast<std::size_t>(size_) ||
      forces.size() != displacements.size()) {
    throw UsageError("instrument forces need one value per gripped dof");
  }
  if (between_.load(std::memory_order_relaxed) & kFresh) {
    reading_ = between_.exchange(reading_, std::memory_order_acq_rel) & ~kFresh;
  }
  const Copy& copy = copies_[reading_];
  const Eigen::Map<const Eigen::VectorXd> d(displacements.data(), size_);
  Eigen::Map<Eigen::VectorXd> h(forces.data(), size_);
  h.setZero();
  if (!copy.filled || !d.allFinite()) return false;
  h = d - copy.u_0;
  copy.l.triangularView<Eigen::Lower>().solveInPlace(h);
  copy.l.transpose().triangularView<Eigen::Upper>().solveInPlace(h);
  h.array() -= anchors_.array() * d.array();
  if (h.allFinite()) return true;
  h.setZero();  // displacements so large that their forces overflow
  return false;
}

}  // namespace sunder
