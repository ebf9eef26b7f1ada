// SPDX-License-Identifier: Apache-2.0
#include "body/damaged_body.hpp"

#include <algorithm>
#include <cmath>

#include "body/assembly.hpp"
#include "body/element.hpp"

namespace sunder::fem {
namespace {

/// Square of the stress tensor's Frobenius norm.
double squared_stress(const Problem& problem, Index e, std::span<const double> u) {
  const Voigt s = stress(problem, e, u);
  return s.head<3>().squaredNorm() + 2 * s.tail<3>().squaredNorm();
}

/// Over the elements element(0) ... element(count - 1).
template <class Element>
double largest_of(const Problem& problem, std::span<const std::uint8_t> destroyed,
                  std::span<const double> u, std::size_t count, Element&& element) {
  double largest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Index e = element(i);
    if (destroyed[e]) continue;
    const double squared = squared_stress(problem, e, u);
    if (!std::isfinite(squared)) return squared;
    largest = std::max(largest, squared);
  }
  return std::sqrt(largest);
}

}  // namespace

DamagedBody::DamagedBody(std::shared_ptr<const Problem> problem) : problem_(std::move(problem)) {
  scale_.assign(problem_->mesh().tets.size(), 1.0);
  destroyed_.assign(scale_.size(), 0);
  nodal_in_.resize(problem_->dofs().size());
  nodal_out_.resize(nodal_in_.size());
}

void DamagedBody::destroy(std::span<const Index> elements) {
  for (Index e : elements) {
    scale_[e] = problem_->scene().fracture.alpha;
    destroyed_[e] = 1;
  }
}

void DamagedBody::scatter(const Eigen::VectorXd& x) const {
  fem::scatter(*problem_, {x.data(), static_cast<std::size_t>(x.size())}, nodal_in_);
}

void DamagedBody::apply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const {
  scatter(x);
  apply_stiffness(*problem_, scale_, nodal_in_, nodal_out_);
  y.resize(x.size());
  gather(*problem_, nodal_out_, {y.data(), static_cast<std::size_t>(y.size())});
}

double DamagedBody::largest_stress(const Eigen::VectorXd& x) const {
  scatter(x);
  return largest_of(*problem_, destroyed_, nodal_in_, destroyed_.size(),
                    [](std::size_t i) { return static_cast<Index>(i); });
}

double DamagedBody::largest_stress(const Eigen::VectorXd& x,
                                   std::span<const Index> elements) const {
  scatter(x);
  return largest_of(*problem_, destroyed_, nodal_in_, elements.size(),
                    [&](std::size_t i) { return elements[i]; });
}

}  // namespace sunder::fem
