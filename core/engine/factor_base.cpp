// SPDX-License-Identifier: Apache-2.0
#include "engine/factor_base.hpp"

#include <algorithm>

namespace sunder::engine {

FactorBase::FactorBase(const fem::Factor& factor) : l_(factor.cholesky()) {
  of_load_.setZero(l_.size());
  y_.resize(l_.size());
}

std::vector<FactorBase::Run> FactorBase::runs_of(std::span<const Index> supernodes) const {
  std::vector<Run> runs;
  Index place = 0;
  for (Index s : supernodes) {
    const Index first = l_.supernodes().first[s], width = l_.supernodes().width(s);
    if (!runs.empty() && runs.back().row + runs.back().length == first) {
      runs.back().length += width;
    } else {
      runs.push_back({first, width, place});
    }
    place += width;
  }
  return runs;
}

FactorBase::Block FactorBase::reduce(const fem::EventFactor& block) {
  places_.clear();
  for (Index d : block.dofs) places_.push_back(l_.supernodes().place[d]);
  const std::vector<Index> path = l_.reach(places_);
  Block added;
  added.runs = runs_of(path);
  const Eigen::Index k = block.w.cols();
  if (work_.cols() != k) work_.setZero(l_.size(), k);
  for (std::size_t i = 0; i < places_.size(); ++i) {
    work_.row(places_[i]) = block.w.row(static_cast<Eigen::Index>(i));
  }
  l_.forward(path, work_);
  added.v.resize(added.runs.empty() ? 0 : added.runs.back().place + added.runs.back().length, k);
  for (const Run& run : added.runs) {
    added.v.middleRows(run.place, run.length) = work_.middleRows(run.row, run.length);
    work_.middleRows(run.row, run.length).setZero();
  }
  return added;
}

Eigen::MatrixXd FactorBase::push(const fem::EventFactor& block) {
  blocks_.push_back(reduce(block));
  const Block& added = blocks_.back();
  const Eigen::Index k = added.v.cols();
  columns_ += k;
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(columns_, k);
  fem::RowMajor product;
  Eigen::Index row = 0;
  for (const Block& b : blocks_) {
    auto target = gram.middleRows(row, b.v.cols());
    row += b.v.cols();
    // The rows that both paths have: they share everything from where they meet up to the root.
    for (std::size_t i = 0, j = 0; i < b.runs.size() && j < added.runs.size();) {
      const Run &r = b.runs[i], &s = added.runs[j];
      const Index begin = std::max(r.row, s.row);
      const Index end = std::min(r.row + r.length, s.row + s.length);
      if (begin < end) {
        const double* left = b.v.row(r.place + begin - r.row).data();
        const double* right = added.v.row(s.place + begin - s.row).data();
        product.resize(b.v.cols(), k);
        fem::row_product({left, b.v.cols(), end - begin, 1, b.v.outerStride()}, right,
                         added.v.outerStride(), k, product.data(), k);
        target += product;
      }
      if (r.row + r.length <= s.row + s.length) {
        ++i;
      } else {
        ++j;
      }
    }
  }
  return gram;
}

void FactorBase::pop() {
  columns_ -= blocks_.back().v.cols();
  blocks_.pop_back();
}

const Eigen::VectorXd& FactorBase::load(const Forces& forces) {
  of_load_.setZero();
  places_.clear();
  for (std::size_t i = 0; i < forces.dofs.size(); ++i) {
    places_.push_back(l_.supernodes().place[forces.dofs[i]]);
    of_load_[places_.back()] = forces.values[i];
  }
  l_.forward(l_.reach(places_), of_load_);
  projected_.resize(columns_);
  Eigen::Index row = 0;
  for (const Block& b : blocks_) {
    gathered_.resize(b.v.rows());
    for (const Run& run : b.runs) {
      gathered_.segment(run.place, run.length) = of_load_.segment(run.row, run.length);
    }
    projected_.segment(row, b.v.cols()).noalias() = b.v.transpose() * gathered_;
    row += b.v.cols();
  }
  return projected_;
}

void FactorBase::expand(const Eigen::VectorXd& c, Eigen::VectorXd& u) {
  y_ = of_load_;
  Eigen::Index row = 0;
  for (const Block& b : blocks_) {
    gathered_.resize(b.v.rows());
    gathered_.noalias() = b.v * c.segment(row, b.v.cols());
    row += b.v.cols();
    for (const Run& run : b.runs) {
      y_.segment(run.row, run.length) += gathered_.segment(run.place, run.length);
    }
  }
  l_.backward(y_);
  const auto& place = l_.supernodes().place;
  u.resize(size());
  for (std::size_t i = 0; i < place.size(); ++i) u[static_cast<Eigen::Index>(i)] = y_[place[i]];
}

std::vector<BufferPlan> FactorBase::buffers() const {
  std::size_t values = 0;
  for (const Block& b : blocks_) values += static_cast<std::size_t>(b.v.size());
  return {{"update vectors along the elimination paths", values * sizeof(double)}};
}

}  // namespace sunder::engine
