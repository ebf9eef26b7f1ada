// SPDX-License-Identifier: Apache-2.0
// A body of a few elements whose elements change, solved afresh after every change: dense, in
// extended precision, from coordinates, E and nu, with the displacement of every new node an
// unknown of its own. It shares no formula with the library.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <stdexcept>
#include <vector>

#include "body/change.hpp"
#include "sunder/problem.hpp"

namespace sunder::test {

class ChangedBody {
 public:
  using Real = long double;
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

  explicit ChangedBody(const Problem& problem) : problem_(&problem) {
    for (Index e = 0; e < problem.tet_count(); ++e) {
      const Material& m = problem.material(e);
      elements_.push_back({problem.mesh().tets[e], m.young, m.poisson, 1});
    }
  }

  void follow(const fem::Change& change) {
    for (const fem::NewNode& n : change.nodes) nodes_.push_back(n);
    for (Index e : change.leave) elements_[e].share = problem_->scene().fracture.alpha;
    for (const fem::Coming& c : change.come) {
      if (c.element == static_cast<Index>(elements_.size())) elements_.emplace_back();
      elements_[c.element] = {c.form.corners, c.form.law.young, c.form.law.poisson, c.form.share};
    }
  }

  [[nodiscard]] Index node_count() const {
    return problem_->node_count() + static_cast<Index>(nodes_.size());
  }
  [[nodiscard]] Index element_count() const { return static_cast<Index>(elements_.size()); }
  [[nodiscard]] const std::array<Index, 4>& corners(Index e) const { return elements_[e].corners; }
  [[nodiscard]] bool live(Index e) const { return elements_[e].share >= 1; }
  [[nodiscard]] const std::vector<fem::NewNode>& new_nodes() const { return nodes_; }
  [[nodiscard]] Index parent(Index node) const {
    return node < problem_->node_count() ? node : nodes_[node - problem_->node_count()].parent;
  }

  struct Solution {
    Vector u;          // at all nodes
    Vector reactions;  // at the gripped unknowns
  };
  /// Under forces at all nodes, 3 a node, and the grips' displacement.
  [[nodiscard]] Solution solve(const std::vector<double>& force, double grip) const {
    const std::vector<Index> place = places();
    Index count = 0;
    for (Index p : place) count = std::max(count, p + 1);
    using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
    Matrix k = Matrix::Zero(count, count);
    for (const Element& element : elements_) add(element, place, k);
    Vector f = Vector::Zero(count), known = Vector::Zero(count);
    for (std::size_t i = 0; i < force.size(); ++i) f[place[i]] += static_cast<Real>(force[i]);
    std::vector<char> fixed(static_cast<std::size_t>(count), 0);
    for (Index i = 0; i < 3 * problem_->node_count(); ++i) {
      if (problem_->dofs()[i] == kNone) fixed[place[i]] = 1;
    }
    std::vector<Index> gripped(problem_->gripped_dofs().size());
    for (Index i = 0; i < 3 * problem_->node_count(); ++i) {
      const auto grips = problem_->gripped_dofs();
      const auto at = std::find(grips.begin(), grips.end(), problem_->dofs()[i]);
      if (at == grips.end()) continue;
      gripped[static_cast<std::size_t>(at - grips.begin())] = place[i];
      fixed[place[i]] = 1;
      known[place[i]] = static_cast<Real>(grip);
    }
    const Vector load = f;
    const Matrix whole = k;
    f -= k * known;
    for (Index i = 0; i < count; ++i) {
      if (!fixed[i] && k(i, i) != 0) continue;
      k.row(i).setZero();
      k.col(i).setZero();
      k(i, i) = 1;
      f[i] = known[i];
    }
    const Eigen::LLT<Matrix> llt(k);
    if (llt.info() != Eigen::Success) throw std::runtime_error("the yardstick is not definite");
    Vector u = llt.solve(f);
    u += llt.solve(f - k * u);
    const Vector lacking = whole * u - load;
    Solution solution;
    solution.u.resize(static_cast<Eigen::Index>(place.size()));
    for (std::size_t i = 0; i < place.size(); ++i) solution.u[i] = u[place[i]];
    solution.reactions.resize(static_cast<Eigen::Index>(gripped.size()));
    for (std::size_t i = 0; i < gripped.size(); ++i) solution.reactions[i] = lacking[gripped[i]];
    return solution;
  }

  /// Stress of an element, a tensor.
  [[nodiscard]] Eigen::Matrix<Real, 3, 3> stress(Index e, const Vector& u) const {
    const Element& element = elements_[e];
    Real volume = 0;
    const auto g = gradients(element, volume);
    Eigen::Matrix<Real, 3, 3> h = Eigen::Matrix<Real, 3, 3>::Zero();
    for (int a = 0; a < 4; ++a) {
      h += u.segment<3>(3 * element.corners[a]) * g.col(a).transpose();
    }
    const Eigen::Matrix<Real, 3, 3> strain = (h + h.transpose()) / 2;
    return element.share * (2 * mu(element) * strain + lambda(element) * strain.trace() *
                                                           Eigen::Matrix<Real, 3, 3>::Identity());
  }

 private:
  struct Element {
    std::array<Index, 4> corners{};
    double young = 0, poisson = 0, share = 0;
  };

  static Real mu(const Element& e) { return Real(e.young) / (2 * (1 + Real(e.poisson))); }
  static Real lambda(const Element& e) {
    const Real nu = e.poisson;
    return Real(e.young) * nu / ((1 + nu) * (1 - 2 * nu));
  }

  Eigen::Matrix<Real, 3, 4> gradients(const Element& element, Real& volume) const {
    Eigen::Matrix<Real, 4, 4> x;
    for (int a = 0; a < 4; ++a) {
      x.row(a) << 1, problem_->mesh().nodes[parent(element.corners[a])].transpose().cast<Real>();
    }
    volume = x.determinant() / 6;
    return x.inverse().bottomRows<3>();
  }

  template <class Matrix>
  void add(const Element& element, const std::vector<Index>& place, Matrix& k) const {
    Real volume = 0;
    const auto g = gradients(element, volume);
    const Real l = element.share * volume * lambda(element),
               m = element.share * volume * mu(element);
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        Eigen::Matrix<Real, 3, 3> block =
            l * g.col(a) * g.col(b).transpose() + m * g.col(b) * g.col(a).transpose();
        block.diagonal().array() += m * g.col(a).dot(g.col(b));
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j) {
            k(place[3 * element.corners[a] + i], place[3 * element.corners[b] + j]) += block(i, j);
          }
        }
      }
    }
  }

  /// Of each node and axis: where a new node keeps to its parent it has its parent's.
  std::vector<Index> places() const {
    std::vector<Index> place;
    for (Index i = 0; i < 3 * problem_->node_count(); ++i) place.push_back(i);
    Index next = 3 * problem_->node_count();
    for (const fem::NewNode& n : nodes_) {
      for (int axis = 0; axis < 3; ++axis) {
        place.push_back(n.axes.has(axis) ? next++ : 3 * n.parent + axis);
      }
    }
    return place;
  }

  const Problem* problem_;
  std::vector<Element> elements_;
  std::vector<fem::NewNode> nodes_;
};

}  // namespace sunder::test
