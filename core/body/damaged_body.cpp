// SPDX-License-Identifier: Apache-2.0
#include "body/damaged_body.hpp"

#include <algorithm>
#include <cmath>

#include "body/assembly.hpp"
#include "body/eight_products.hpp"
#include "body/element.hpp"
#include "body/held_together.hpp"
#include "body/pools.hpp"
#include "sunder/error.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder::fem {
namespace {

/// Square of a stress tensor's Frobenius norm.
double squared(const Voigt& s) { return s.head<3>().squaredNorm() + 2 * s.tail<3>().squaredNorm(); }

/// Of the displacement at all nodes of the mesh.
Voigt stress_of(const Form& form, std::span<const double> u) {
  Eigen::Matrix<double, 3, 4> displacement;
  for (int a = 0; a < 4; ++a) displacement.col(a) = Vec3(&u[3 * form.corners[a]]);
  return form.share * stress(form.shape, form.law, displacement);
}

/// Of the squared norms of stress; not finite when one of them is not.
class Largest {
 public:
  void add(double value) {
    if (!std::isfinite(largest_)) return;
    largest_ = std::isfinite(value) ? std::max(largest_, value) : value;
  }
  [[nodiscard]] double norm() const {
    return std::isfinite(largest_) ? std::sqrt(largest_) : largest_;
  }

 private:
  double largest_ = 0;
};

}  // namespace

DamagedBody::DamagedBody(std::shared_ptr<const Problem> problem)
    : problem_(std::move(problem)),
      record_(std::make_shared<Record>()),
      forms_(*problem_),
      scale_(problem_->mesh().tets.size(), 1.0),
      nodal_in_(problem_->dofs().size()),
      nodal_out_(nodal_in_) {}

void DamagedBody::reserve() {
  const std::lock_guard lock(record_->mutex);
  record_->damage.reserve(scale_.size(), scale_.size());
}

void DamagedBody::destroy(std::span<const Index> elements) { record({.leave = elements}); }

bool DamagedBody::change(const Change& change) {
  check(forms_, change);
  if (!holds_together(forms_, change)) return false;
  record(change);
  return true;
}

void DamagedBody::grip(std::span<const Index> grasp, std::span<const Index> release) {
  record({.grasp = grasp, .release = release});
}

void DamagedBody::record(const Event& event) {
  {
    const std::lock_guard lock(record_->mutex);
    if (events_ != record_->damage.size()) throw UsageError("a copy of a body records no events");
    record_->damage.add(event);
  }
  follow(event);
}

void DamagedBody::follow(const Event& event, bool more) {
  forms_.add(event.nodes);
  forms_.follow(event, more);
  ++events_;
  for (Index e : event.leave) {
    if (e < problem_->tet_count()) scale_[e] = problem_->scene().fracture.alpha;
  }
  if (forms_.came().empty()) return;
  others_.clear();
  for (const auto& [element, form] : forms_.came()) {
    const bool other = element >= problem_->tet_count() ||
                       !same_matter(forms_, form, form_in_mesh(*problem_, element));
    if (other && form.share > 0) others_.push_back(form);
    if (element < problem_->tet_count()) scale_[element] = other ? 0 : form.share;
  }
}

void DamagedBody::follow(std::size_t events) {
  for (Change event; events_ < events;) {
    read(events_, event);
    follow(event, events_ + 1 < events);
  }
}

void DamagedBody::take_back(std::size_t events) {
  if (events == events_) return;
  DamagedBody body = as_of(events);
  {
    const std::lock_guard lock(record_->mutex);
    while (record_->damage.size() > events) record_->damage.take_back();
  }
  forms_ = std::move(body.forms_);
  scale_.swap(body.scale_);
  others_.swap(body.others_);
  events_ = events;
}

DamagedBody DamagedBody::as_of(std::size_t events) const {
  DamagedBody body(problem_);
  body.record_ = record_;
  body.follow(events);
  return body;
}

void DamagedBody::read(std::size_t event, Change& change) const {
  const std::lock_guard lock(record_->mutex);
  const Event of = record_->damage[event];
  change.leave.assign(of.leave.begin(), of.leave.end());
  change.come.assign(of.come.begin(), of.come.end());
  change.nodes.assign(of.nodes.begin(), of.nodes.end());
  change.ties.assign(of.ties.begin(), of.ties.end());
  change.held = true;  // or it would not have been recorded
  change.grasp.assign(of.grasp.begin(), of.grasp.end());
  change.release.assign(of.release.begin(), of.release.end());
}

std::vector<Index> DamagedBody::changed(std::size_t begin, std::size_t end) const {
  std::vector<Index> elements;
  std::vector<std::uint8_t> seen;
  const auto add = [&](Index e) {
    const auto at = static_cast<std::size_t>(e);
    seen.resize(std::max(seen.size(), at + 1), 0);
    if (seen[at]) return;
    seen[at] = 1;
    elements.push_back(e);
  };
  const std::lock_guard lock(record_->mutex);
  for (std::size_t i = begin; i < end; ++i) {
    const Event event = record_->damage[i];
    for (Index e : event.leave) add(e);
    for (const Coming& c : event.come) add(c.element);
  }
  return elements;
}

void DamagedBody::refuse_new_unknowns() const {
  if (!forms_.new_nodes().empty()) throw UsageError("a base cannot take new unknowns over");
}

linear_algebra::SparseMatrix DamagedBody::stiffness() const {
  refuse_new_unknowns();
  linear_algebra::SparseMatrix k = assemble_lower(*problem_, scale_, forms_.pools());
  if (!others_.empty()) k += assemble_forms(*problem_, others_);
  return k;
}

void DamagedBody::scatter(const Eigen::VectorXd& x) const {
  refuse_new_unknowns();
  fem::scatter(*problem_, {x.data(), static_cast<std::size_t>(x.size())}, nodal_in_);
}

void DamagedBody::apply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const {
  scatter(x);
  apply_stiffness(*problem_, scale_, nodal_in_, nodal_out_, forms_.pools());
  for (const Form& form : others_) {
    const Eigen::Matrix<double, 3, 4> force =
        form.shape.volume * (tensor(stress_of(form, nodal_in_)) * form.shape.gradient);
    for (int a = 0; a < 4; ++a) Eigen::Map<Vec3>(&nodal_out_[3 * form.corners[a]]) += force.col(a);
  }
  y.resize(x.size());
  gather(*problem_, nodal_out_, {y.data(), static_cast<std::size_t>(y.size())});
}

void DamagedBody::apply(const Eigen::Ref<const Eigen::MatrixXd>& x, Eigen::MatrixXd& y) const {
  y.resize(x.rows(), x.cols());
  if (problem_->pools() || !others_.empty()) {
    Eigen::VectorXd of;
    for (Eigen::Index c = 0; c < x.cols(); ++c) {
      apply(x.col(c), of);
      y.col(c) = of;
    }
    return;
  }
  refuse_new_unknowns();
  const auto dofs = problem_->dofs();
  eight_in_.resize(dofs.size() * kProductsAtOnce);
  eight_out_.resize(eight_in_.size());
  for (Eigen::Index first = 0; first < x.cols(); first += kProductsAtOnce) {
    const auto count = std::min<Eigen::Index>(kProductsAtOnce, x.cols() - first);
    std::fill(eight_in_.begin(), eight_in_.end(), 0.0);
    for (std::size_t i = 0; i < dofs.size(); ++i) {
      if (dofs[i] == kNone) continue;
      for (Eigen::Index c = 0; c < count; ++c) {
        eight_in_[i * kProductsAtOnce + static_cast<std::size_t>(c)] = x(dofs[i], first + c);
      }
    }
    apply_stiffness_to_eight(*problem_, scale_, eight_in_, eight_out_);
    for (std::size_t i = 0; i < dofs.size(); ++i) {
      if (dofs[i] == kNone) continue;
      for (Eigen::Index c = 0; c < count; ++c) {
        y(dofs[i], first + c) = eight_out_[i * kProductsAtOnce + static_cast<std::size_t>(c)];
      }
    }
  }
}

double DamagedBody::largest_stress(const Eigen::VectorXd& x) const {
  scatter(x);
  const StressField field(*problem_, scale_, nodal_in_, forms_.pools());
  Largest largest;
  for (Index e = 0; e < problem_->tet_count(); ++e) {
    if (!destroyed()[e]) largest.add(squared(scale_[e] * field.of(e)));
  }
  for (const Form& form : others_) largest.add(squared(stress_of(form, nodal_in_)));
  return largest.norm();
}

double DamagedBody::largest_stress(const Eigen::VectorXd& x,
                                   std::span<const Index> elements) const {
  scatter(x);
  const StressField field(*problem_, scale_, nodal_in_, forms_.pools());
  Largest largest;
  for (Index e : elements) {
    if (!destroyed()[e]) largest.add(squared(scale_[e] * field.of(e)));
  }
  return largest.norm();
}

}  // namespace sunder::fem
