// SPDX-License-Identifier: Apache-2.0
#include "body/pools.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "body/element.hpp"

namespace sunder::fem {
namespace {

using Neighbours = std::vector<std::array<Index, 4>>;

bool pools(const Problem& problem, Index e) {
  return problem.material(e).volume == MaterialVolume::pooled;
}

/// Elements across the faces of each that pool with it; kNone: none.
Neighbours neighbours_of(const Problem& problem) {
  struct Face {
    std::array<Index, 3> nodes;
    Index element;
    std::size_t side;
    bool operator<(const Face& other) const {
      return nodes != other.nodes ? nodes < other.nodes : element < other.element;
    }
  };
  std::vector<Face> faces;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    if (!pools(problem, e)) continue;
    const auto& tet = problem.mesh().tets[static_cast<std::size_t>(e)];
    for (std::size_t side = 0; side < 4; ++side) {
      std::array<Index, 3> nodes{tet[(side + 1) % 4], tet[(side + 2) % 4], tet[(side + 3) % 4]};
      std::sort(nodes.begin(), nodes.end());
      faces.push_back({nodes, e, side});
    }
  }
  std::sort(faces.begin(), faces.end());
  Neighbours neighbours(static_cast<std::size_t>(problem.tet_count()),
                        {kNone, kNone, kNone, kNone});
  const auto& volume_of = problem.mesh().volume_of;
  for (std::size_t i = 0; i + 1 < faces.size(); ++i) {
    const Face &a = faces[i], &b = faces[i + 1];
    const auto one = static_cast<std::size_t>(a.element), two = static_cast<std::size_t>(b.element);
    if (a.nodes != b.nodes || volume_of[one] != volume_of[two]) continue;
    neighbours[one][a.side] = b.element;
    neighbours[two][b.side] = a.element;
  }
  return neighbours;
}

Vec3 centroid(const Problem& problem, Index e) {
  Vec3 sum = Vec3::Zero();
  for (Index n : problem.mesh().tets[static_cast<std::size_t>(e)]) {
    sum += problem.mesh().nodes[static_cast<std::size_t>(n)];
  }
  return sum / 4;
}

/// Lets patches grow side by side over the mesh, each begun where the fewest free elements are
/// left: so few are left over.
class Growth {
 public:
  explicit Growth(const Problem& problem) : problem_(problem), neighbours_(neighbours_of(problem)) {
    const auto size = neighbours_.size();
    patch_.assign(size, kNone);
    free_.assign(size, 0);
    for (Index e = 0; e < problem.tet_count(); ++e) {
      if (!pools(problem, e)) continue;
      for (Index n : neighbours_[at(e)]) free_[at(e)] += n != kNone ? 1 : 0;
      others_.emplace(free_[at(e)], e);
    }
    while (!others_.empty() || !front_.empty()) grow();
    for (std::size_t p = 0; p < members_.size(); ++p) {
      if (members_[p].size() < Pools::kFewest) join(p);
    }
  }

  /// Elements of each patch, ascending; the patches by their first.
  [[nodiscard]] std::vector<std::vector<Index>> patches() && {
    std::vector<std::vector<Index>> patches;
    for (std::vector<Index>& of : members_) {
      if (of.empty()) continue;
      std::sort(of.begin(), of.end());
      patches.push_back(std::move(of));
    }
    std::sort(patches.begin(), patches.end());
    return patches;
  }

 private:
  static std::size_t at(Index e) { return static_cast<std::size_t>(e); }

  /// One patch from a free element.
  void grow() {
    std::vector<Index> members;
    Vec3 sum = Vec3::Zero();
    Index next = (front_.empty() ? others_ : front_).begin()->second;
    while (next != kNone) {
      take(next);
      members.push_back(next);
      sum += centroid(problem_, next);
      next = members.size() < Pools::kSize
                 ? best_beside(members, sum / static_cast<double>(members.size()))
                 : kNone;
    }
    members_.push_back(std::move(members));
  }

  void take(Index e) {
    front_.erase({free_[at(e)], e});
    others_.erase({free_[at(e)], e});
    patch_[at(e)] = static_cast<Index>(members_.size());
    for (Index n : neighbours_[at(e)]) {
      if (n == kNone || patch_[at(n)] != kNone) continue;
      front_.erase({free_[at(n)], n});
      others_.erase({free_[at(n)], n});
      front_.emplace(--free_[at(n)], n);
    }
  }

  /// The free neighbour with the most faces in the patch; of several the nearest to its middle.
  [[nodiscard]] Index best_beside(const std::vector<Index>& members, const Vec3& middle) const {
    constexpr double kTie = 1e-9;  // distances that differ by rounding are the same
    const auto patch = static_cast<Index>(members_.size());
    Index best = kNone;
    int most = 0;
    double nearest = 0;
    for (Index e : members) {
      for (Index n : neighbours_[at(e)]) {
        if (n == kNone || patch_[at(n)] != kNone) continue;
        int shared = 0;
        for (Index m : neighbours_[at(n)]) shared += m != kNone && patch_[at(m)] == patch ? 1 : 0;
        const double distance = (centroid(problem_, n) - middle).squaredNorm();
        const bool tie = std::abs(distance - nearest) <= kTie * nearest;
        const bool nearer = tie ? n < best : distance < nearest;
        if (best != kNone && (shared < most || (shared == most && !nearer))) continue;
        best = n;
        most = shared;
        nearest = distance;
      }
    }
    return best;
  }

  /// A patch too small joins the smallest beside it.
  void join(std::size_t patch) {
    Index into = kNone;
    for (Index e : members_[patch]) {
      for (Index n : neighbours_[at(e)]) {
        if (n == kNone || patch_[at(n)] == static_cast<Index>(patch)) continue;
        const Index other = patch_[at(n)];
        const auto size = members_[at(other)].size();
        const bool better = into == kNone || size < members_[at(into)].size() ||
                            (size == members_[at(into)].size() && other < into);
        if (better) into = other;
      }
    }
    if (into == kNone) return;  // a piece of so few elements
    for (Index e : members_[patch]) {
      patch_[at(e)] = into;
      members_[at(into)].push_back(e);
    }
    members_[patch].clear();
  }

  const Problem& problem_;
  Neighbours neighbours_;
  std::vector<Index> patch_;                        // of each element, kNone: free
  std::vector<int> free_;                           // free neighbours of each element
  std::set<std::pair<int, Index>> front_, others_;  // free ones beside a patch, and the rest
  std::vector<std::vector<Index>> members_;
};

/// V_p of a patch.
template <class Share>
double volume(const Problem& problem, std::span<const Index> elements, const Share& share) {
  double sum = 0;
  for (Index e : elements) sum += share(e) * problem.shape(e).volume;
  return sum;
}

}  // namespace

Pools::Pools(const Problem& problem) : of_(static_cast<std::size_t>(problem.tet_count()), kNone) {
  begin_.push_back(0);
  for (const std::vector<Index>& patch : Growth(problem).patches()) {
    for (Index e : patch) of_[static_cast<std::size_t>(e)] = count();
    elements_.insert(elements_.end(), patch.begin(), patch.end());
    begin_.push_back(elements_.size());
    bulk_.push_back(problem.small_strain(patch.front()).triple_bulk / 3);
    small_ += patch.size() < kFewest ? 1 : 0;
  }
}

std::shared_ptr<const Pools> Pools::split(const std::function<Index(Index)>& body_of) const {
  std::vector<std::vector<Index>> first, further;
  std::vector<double> bulk = bulk_, of_further;
  std::vector<std::pair<Index, std::size_t>> parts;  // by body: where in `further`
  for (Index p = 0; p < count(); ++p) {
    std::vector<Index>& stay = first.emplace_back();
    Index body = kNone;
    parts.clear();
    for (Index e : elements(p)) {
      const Index of = body_of(e);
      if (body == kNone) body = of;
      if (of == kNone || of == body) {
        stay.push_back(e);
        continue;
      }
      auto part = std::ranges::find(parts, of, &std::pair<Index, std::size_t>::first);
      if (part == parts.end()) {
        part = parts.insert(parts.end(), {of, further.size()});
        further.emplace_back();
        of_further.push_back(bulk_[static_cast<std::size_t>(p)]);
      }
      further[part->second].push_back(e);
    }
  }
  if (further.empty()) return nullptr;
  const std::shared_ptr<Pools> made(new Pools);
  made->of_ = of_;
  made->small_ = small_;
  made->bulk_ = std::move(bulk);
  made->bulk_.insert(made->bulk_.end(), of_further.begin(), of_further.end());
  first.insert(first.end(), further.begin(), further.end());
  made->begin_.push_back(0);
  for (std::size_t p = 0; p < first.size(); ++p) {
    for (Index e : first[p]) made->of_[static_cast<std::size_t>(e)] = static_cast<Index>(p);
    made->elements_.insert(made->elements_.end(), first[p].begin(), first[p].end());
    made->begin_.push_back(made->elements_.size());
  }
  return made;
}

Pools::Pools(const Pools& whole, const CornersOf& corners, std::span<const Index> changed)
    : of_(whole.of_), bulk_(whole.bulk_), small_(whole.small_) {
  std::vector<Index> touched;
  whole.of(changed, touched);
  std::vector<std::vector<Index>> patches;
  for (Index p = 0; p < whole.count(); ++p) {
    patches.emplace_back(whole.elements(p).begin(), whole.elements(p).end());
  }
  for (Index p : touched) {
    auto parts = whole.hanging_together(p, corners);
    for (std::size_t i = 1; i < parts.size(); ++i) {
      bulk_.push_back(whole.bulk(p));
      for (Index e : parts[i]) {
        of_[static_cast<std::size_t>(e)] = static_cast<Index>(patches.size());
      }
      patches.push_back(std::move(parts[i]));
    }
    patches[static_cast<std::size_t>(p)] = std::move(parts.front());
  }
  begin_.push_back(0);
  for (const std::vector<Index>& patch : patches) {
    elements_.insert(elements_.end(), patch.begin(), patch.end());
    begin_.push_back(elements_.size());
  }
}

std::vector<std::vector<Index>> Pools::parts_of(const Pools& whole, Index patch) const {
  std::vector<std::vector<Index>> parts;
  std::vector<Index> patches;
  for (Index e : whole.elements(patch)) {
    const auto at = std::ranges::find(patches, of(e)) - patches.begin();
    if (at == std::ssize(patches)) {
      patches.push_back(of(e));
      parts.emplace_back();
    }
    parts[static_cast<std::size_t>(at)].push_back(e);
  }
  return parts;
}

/// Elements of a patch that hang together by faces with these corners, by their first ones.
std::vector<std::vector<Index>> Pools::hanging_together(Index patch,
                                                        const CornersOf& corners) const {
  const auto all = elements(patch);
  const auto hang_together = [&](Index a, Index b) {
    const auto &one = corners(a), &two = corners(b);
    return std::ranges::count_if(
               one, [&](Index n) { return std::ranges::find(two, n) != two.end(); }) >= 3;
  };
  std::vector<std::uint8_t> seen(all.size(), 0);
  std::vector<std::vector<Index>> parts;
  for (std::size_t first = 0; first < all.size(); ++first) {
    if (seen[first]) continue;
    seen[first] = 1;
    std::vector<Index> part{all[first]};
    for (std::size_t i = 0; i < part.size(); ++i) {
      for (std::size_t other = 0; other < all.size(); ++other) {
        if (seen[other] || !hang_together(part[i], all[other])) continue;
        seen[other] = 1;
        part.push_back(all[other]);
      }
    }
    std::ranges::sort(part);
    parts.push_back(std::move(part));
  }
  return parts;
}

std::vector<Index> Pools::nodes(const Problem& problem, Index patch) const {
  std::vector<Index> nodes;
  for (Index e : elements(patch)) {
    const auto& tet = problem.mesh().tets[static_cast<std::size_t>(e)];
    nodes.insert(nodes.end(), tet.begin(), tet.end());
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

void Pools::of(std::span<const Index> elements, std::vector<Index>& patches) const {
  patches.clear();
  for (Index e : elements) {
    if (e < static_cast<Index>(of_.size()) && of(e) != kNone) patches.push_back(of(e));
  }
  std::sort(patches.begin(), patches.end());
  patches.erase(std::unique(patches.begin(), patches.end()), patches.end());
}

std::shared_ptr<const Pools> pools_of(const Problem& problem) {
  for (Index e = 0; e < problem.tet_count(); ++e) {
    if (pools(problem, e)) return std::make_shared<const Pools>(problem);
  }
  return nullptr;
}

std::shared_ptr<const Pools> parted_pools(const Problem& problem,
                                          const std::shared_ptr<const Pools>& whole,
                                          std::span<const std::array<Index, 4>> corners) {
  if (!whole) return nullptr;
  std::vector<Index> changed;
  for (std::size_t e = 0; e < corners.size(); ++e) {
    if (corners[e] != problem.mesh().tets[e]) changed.push_back(static_cast<Index>(e));
  }
  if (changed.empty()) return whole;
  const auto now = [&](Index e) -> const std::array<Index, 4>& {
    return corners[static_cast<std::size_t>(e)];
  };
  return std::make_shared<const Pools>(*whole, now, changed);
}

void append_pressure(const Problem& problem, std::span<const Index> elements, Index number,
                     const ShareOf& share, std::vector<StiffnessPart>& parts) {
  const double bulk = problem.pools()->bulk(problem.pools()->of(elements.front()));
  const double root = std::sqrt(bulk / volume(problem, elements, share));
  for (Index e : elements) {
    StiffnessPart& part = parts.emplace_back();
    part.nodes = problem.mesh().tets[static_cast<std::size_t>(e)];
    part.patch = number;
    part.u.setZero();
    const TetShape& shape = problem.shape(e);
    part.u.col(0) = root * share(e) * shape.volume *
                    Eigen::Map<const Eigen::Matrix<double, 12, 1>>(shape.gradient.data());
  }
}

void append_pressure(const Problem& problem, Index patch, const Pools& now, const ShareOf& share,
                     std::vector<StiffnessPart>& parts) {
  Index number = patch;
  for (const std::vector<Index>& part : now.parts_of(*problem.pools(), patch)) {
    append_pressure(problem, part, number, share, parts);
    number += problem.pools()->count();
  }
}

linear_algebra::SparseMatrix assemble_pressure(const Problem& problem,
                                               std::span<const double> scale, const Pools* now) {
  const Pools& pools = now ? *now : *problem.pools();
  const auto share = [&](Index e) {
    return scale.empty() ? 1.0 : scale[static_cast<std::size_t>(e)];
  };
  std::vector<Eigen::Triplet<double, Index>> triplets;
  std::vector<Index> dofs;
  Eigen::VectorXd b;
  for (Index p = 0; p < pools.count(); ++p) {
    const std::vector<Index> nodes = pools.nodes(problem, p);
    b.setZero(3 * static_cast<Eigen::Index>(nodes.size()));
    dofs.clear();
    for (Index n : nodes) {
      for (int axis = 0; axis < 3; ++axis) dofs.push_back(problem.dof(n, axis));
    }
    for (Index e : pools.elements(p)) {
      const TetShape& shape = problem.shape(e);
      const auto& tet = problem.mesh().tets[static_cast<std::size_t>(e)];
      for (int a = 0; a < 4; ++a) {
        const auto place =
            std::lower_bound(nodes.begin(), nodes.end(), tet[static_cast<std::size_t>(a)]) -
            nodes.begin();
        b.segment<3>(3 * place) += share(e) * shape.volume * shape.gradient.col(a);
      }
    }
    const double factor = pools.bulk(p) / volume(problem, pools.elements(p), share);
    for (std::size_t j = 0; j < dofs.size(); ++j) {
      for (std::size_t i = 0; i < dofs.size(); ++i) {
        if (dofs[j] == kNone || dofs[i] < dofs[j]) continue;  // kNone < every dof
        triplets.emplace_back(
            dofs[i], dofs[j],
            factor * b[static_cast<Eigen::Index>(i)] * b[static_cast<Eigen::Index>(j)]);
      }
    }
  }
  linear_algebra::SparseMatrix matrix(problem.dof_count(), problem.dof_count());
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

StressField::StressField(const Problem& problem, std::span<const double> scale,
                         std::span<const double> u, const Pools* now)
    : problem_(problem), u_(u), pools_(now ? now : problem.pools()) {
  const Pools* const pools = pools_;
  if (!pools) return;
  pressure_.reserve(static_cast<std::size_t>(pools->count()));
  const auto share = [&](Index e) {
    return scale.empty() ? 1.0 : scale[static_cast<std::size_t>(e)];
  };
  for (Index p = 0; p < pools->count(); ++p) {
    double change = 0;
    for (Index e : pools->elements(p)) {
      const TetShape& shape = problem.shape(e);
      const Eigen::Matrix<double, 3, 4> d = corner_displacement(problem.mesh(), e, u);
      const Mat3 h =
          (d.rightCols<3>().colwise() - d.col(0)) * shape.gradient.rightCols<3>().transpose();
      change += share(e) * shape.volume * h.trace();
    }
    pressure_.push_back(pools->bulk(p) * change / volume(problem, pools->elements(p), share));
  }
}

Voigt StressField::of(Index element) const {
  Voigt s = stress_by_itself(problem_, element, u_);
  if (pressure_.empty()) return s;
  const Index patch = pools_->of(element);
  if (patch != kNone) s.head<3>().array() += pressure_[static_cast<std::size_t>(patch)];
  return s;
}

}  // namespace sunder::fem
