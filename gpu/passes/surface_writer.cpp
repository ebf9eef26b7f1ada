// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/surface_writer.hpp"

#include <algorithm>
#include <limits>

#include "gpu/passes/display.hpp"
#include "gpu/passes/two_floats.hpp"
#include "gpu/vulkan/host_commands.hpp"
#include "sunder/fracture_model.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder::gpu {
namespace {

using vulkan::Buffer;
using vulkan::Placement;

constexpr std::uint32_t kNowhere = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint32_t kItemBytes = 12, kValuesBytes = 16;  // of three words; of four

std::uint32_t groups_for(std::uint32_t count) {
  return round_up(std::max(count, 1u), shaders::kGroup) / shaders::kGroup;
}

/// Elements around each node: where they begin, and their ids, ascending.
struct Around {
  std::vector<std::uint32_t> first, elements;
};

Around elements_around(const Mesh& mesh) {
  Around around;
  around.first.assign(mesh.nodes.size() + 1, 0);
  for (const auto& tet : mesh.tets) {
    for (Index n : tet) ++around.first[static_cast<std::size_t>(n) + 1];
  }
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) around.first[n + 1] += around.first[n];
  around.elements.resize(4 * mesh.tets.size());
  std::vector<std::uint32_t> next(around.first.begin(), around.first.end() - 1);
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    for (Index n : mesh.tets[e]) {
      around.elements[next[static_cast<std::size_t>(n)]++] = static_cast<std::uint32_t>(e);
    }
  }
  return around;
}

template <class T>
Buffer filled(vulkan::Device& device, const std::vector<T>& values) {
  Buffer buffer(device, values.size() * sizeof(T), Placement::device);
  buffer.write(std::span<const T>(values));
  return buffer;
}

}  // namespace

SurfaceWriter::SurfaceWriter(const LentField& field, const Simulation& simulation, const Skin* skin,
                             const SurfaceTargets& targets)
    : device_(field.kernels->device()),
      kernels_(*field.kernels),
      simulation_(simulation),
      displacement_(field.displacement),
      stress_(field.stress),
      given_(targets),
      elements_(static_cast<std::uint32_t>(simulation.problem().tet_count())),
      shows_(elements_, 0),
      corners_(simulation.problem().mesh().tets),
      is_touched_(elements_, 0),
      nothing_(device_, 16, Placement::device),
      places_(bound(targets.places)),
      normals_(bound(targets.normals)),
      triangles_(bound(targets.triangles)),
      facts_(bound(targets.facts)),
      skin_(bound(targets.skin)),
      skin_lives_(bound(targets.skin_lives)),
      values_(bound(targets.values)),
      changes_kernel_(kernels_.make_fp64("surface_changes")),
      points_kernel_(kernels_.make_fp64("surface_points")) {
  upload_mesh();
  if (values_.stride > 0) {
    // Four faces an element at most.
    on_device_elements_ = Buffer(device_, std::size_t{16} * elements_, Placement::device);
    // Stress that the host writes is in fp32.
    values_kernel_ = (displacement_ ? kernels_ : kernels_.in_fp32()).make("surface_values");
    if (!displacement_) {
      own_stress_ = Buffer(device_, std::size_t{16} * elements_, Placement::sent);
    }
  }
  if (skin) upload_skin(*skin);
  make_room(static_cast<std::size_t>(simulation.backend().node_count()));
}

/// Vulkan binds at multiples of its own; the kernels count on from there.
SurfaceWriter::Target SurfaceWriter::bound(const LentItems& items) {
  Target target;
  if (!items.buffer) return target;
  const VkDeviceSize beyond = items.offset % kDisplayAlignment;
  target.buffer = Buffer::lent(items.buffer, items.offset - beyond, items.bytes + beyond);
  target.at = static_cast<std::uint32_t>(beyond / 4);
  target.stride = items.stride / 4;
  return target;
}

void SurfaceWriter::upload_mesh() {
  const Mesh& mesh = simulation_.problem().mesh();
  std::vector<double> rest(4 * mesh.nodes.size(), 0.0);
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    std::copy_n(mesh.nodes[n].data(), 3, rest.begin() + static_cast<std::ptrdiff_t>(4 * n));
  }
  rest_ = Buffer(device_, rest.size() * sizeof(double), Placement::device);
  write_wide(kernels_, rest_, rest);
  const Around around = elements_around(mesh);
  first_ = filled(device_, around.first);
  around_ = filled(device_, around.elements);
  on_device_corners_ = Buffer(device_, std::size_t{16} * elements_, Placement::device);
  on_device_shows_ = Buffer(device_, std::size_t{4} * elements_, Placement::device);
}

void SurfaceWriter::upload_skin(const Skin& skin) {
  vertices_ = static_cast<std::uint32_t>(skin.size());
  if (vertices_ == 0) return;
  std::vector<double> shares;
  std::vector<std::uint32_t> carriers;
  for (const Skin::Carrier& carrier : skin.carriers()) {
    shares.insert(shares.end(), carrier.share.begin(), carrier.share.end());
    carriers.push_back(static_cast<std::uint32_t>(carrier.element));
  }
  shares_ = Buffer(device_, shares.size() * sizeof(double), Placement::device);
  write_wide(kernels_, shares_, shares);
  carriers_ = filled(device_, carriers);
  skin_kernel_ = kernels_.make_fp64("surface_skin");
}

/// For the body's nodes; those that splitting brings are never on a host's device.
void SurfaceWriter::make_room(std::size_t nodes) {
  if (nodes <= room_) return;
  room_ = std::max(nodes, 2 * room_);
  drawn_ = 0;  // all is written anew
  points_binding_.reset();
  skin_binding_.reset();
  values_binding_.reset();
  changes_binding_.reset();
  on_device_parents_ = Buffer(device_, 4 * room_, Placement::device);
  if (!displacement_) {
    own_displacement_ = Buffer(device_, 4 * sizeof(double) * room_, Placement::sent);
  }
  bind();
}

void SurfaceWriter::bind() {
  const auto of = [this](const Target& target) {
    return target.stride > 0 ? &target.buffer : &nothing_;
  };
  const Buffer* u = displacement_ ? displacement_ : &own_displacement_;
  const Buffer* points[] = {u,
                            &rest_,
                            &on_device_parents_,
                            &first_,
                            &around_,
                            &on_device_corners_,
                            &on_device_shows_,
                            of(places_),
                            of(normals_)};
  points_binding_ = std::make_unique<vulkan::Binding>(device_, *points_kernel_, points);
  if (values_kernel_) {
    const Buffer* stress = stress_ ? stress_ : displacement_ ? &nothing_ : &own_stress_;
    const Buffer* values[] = {
        u,      &rest_,         &on_device_parents_, &on_device_corners_, &on_device_elements_,
        stress, &values_.buffer};
    values_binding_ = std::make_unique<vulkan::Binding>(device_, *values_kernel_, values);
  }
  if (!skin_kernel_) return;
  const Buffer* skin[] = {
      u,        &rest_,     &on_device_parents_, &on_device_corners_, &on_device_shows_,
      &shares_, &carriers_, of(skin_),           of(skin_lives_)};
  skin_binding_ = std::make_unique<vulkan::Binding>(device_, *skin_kernel_, skin);
}

void SurfaceWriter::bind_changes() {
  const Buffer* changes[] = {&changes_,
                             &on_device_corners_,
                             &on_device_shows_,
                             &on_device_parents_,
                             triangles_.stride > 0 ? &triangles_.buffer : &nothing_,
                             facts_.stride > 0 ? &facts_.buffer : &nothing_,
                             values_.stride > 0 ? &on_device_elements_ : &nothing_};
  changes_binding_ = std::make_unique<vulkan::Binding>(device_, *changes_kernel_, changes);
}

std::optional<TargetTooSmall> SurfaceWriter::too_small(const Surface& surface) const {
  const std::uint64_t nodes = surface.node_count(), triangles = surface.triangles().size();
  const struct {
    const LentItems& items;
    const char* what;
    std::uint64_t count, bytes;
  } all[] = {{given_.places, "places", nodes, kItemBytes},
             {given_.normals, "normals", nodes, kItemBytes},
             {given_.triangles, "triangles", triangles, kItemBytes},
             {given_.facts, "facts", triangles, kItemBytes},
             {given_.skin, "skin", vertices_, kItemBytes},
             {given_.skin_lives, "skin_lives", vertices_, 4},
             {given_.values, "values", triangles, kValuesBytes}};
  for (const auto& target : all) {
    if (!target.items.buffer || target.count == 0) continue;
    const std::uint64_t needed = (target.count - 1) * target.items.stride + target.bytes;
    if (target.items.bytes < needed) return {{target.what, target.items.bytes, needed}};
  }
  return {};
}

std::array<Index, 4> SurfaceWriter::corners_now(Index element) const {
  const auto split = simulation_.corners();
  return split.empty() ? simulation_.problem().mesh().tets[static_cast<std::size_t>(element)]
                       : split[static_cast<std::size_t>(element)];
}

std::uint32_t SurfaceWriter::slot_of(const SurfaceTriangle& triangle) const {
  const auto corners = corners_now(triangle.element);
  std::uint32_t opposite = 0;
  while (std::ranges::find(triangle.nodes, corners[opposite]) != triangle.nodes.end()) ++opposite;
  return 4 * static_cast<std::uint32_t>(triangle.element) + opposite;
}

void SurfaceWriter::touch(Index element) {
  if (is_touched_[static_cast<std::size_t>(element)]) return;
  is_touched_[static_cast<std::size_t>(element)] = 1;
  touched_.push_back(element);
}

/// A triangle that goes leaves its place to another: what was there is taken back first.
void SurfaceWriter::follow_triangles(const Surface& surface) {
  const std::vector<std::uint32_t> places = surface.changed_since(drawn_);
  const auto triangles = surface.triangles();
  for (std::uint32_t place : places) {
    if (place >= slots_.size() || slots_[place] == kNowhere) continue;
    const std::uint32_t slot = slots_[place];
    shows_[slot / 4] &= ~(1u << slot % 4);
    touch(static_cast<Index>(slot / 4));
    slots_[place] = kNowhere;
  }
  const std::size_t before = slots_.size();
  slots_.resize(triangles.size(), kNowhere);
  for (std::uint32_t place : places) {
    if (place >= triangles.size()) {
      // No corner of it is drawn, if a host draws more than there is.
      if (place < before) list_.insert(list_.end(), {place, 0, 0, 0, kNowhere, kNowhere, 0});
      continue;
    }
    const SurfaceTriangle& t = triangles[place];
    const std::uint32_t slot = slot_of(t);
    slots_[place] = slot;
    shows_[slot / 4] |= 1u << slot % 4;
    touch(t.element);
    const auto word = [](Index i) { return static_cast<std::uint32_t>(i); };
    list_.insert(list_.end(), {place, word(t.nodes[0]), word(t.nodes[1]), word(t.nodes[2]),
                               word(t.element), word(t.piece), t.opened ? 1u : 0u});
  }
}

/// Corners, what is gone, and the nodes that have come: none of it changes without a triangle.
void SurfaceWriter::follow_elements() {
  const auto gone = simulation_.backend().destroyed();
  const auto& mesh = simulation_.problem().mesh();
  const auto nodes = static_cast<std::size_t>(simulation_.backend().node_count());
  if (drawn_ == 0) {
    for (Index e = 0; e < static_cast<Index>(elements_); ++e) touch(e);
  }
  for (std::size_t n = parents_.size(); n < nodes; ++n) {
    parents_.push_back(n < mesh.nodes.size() ? static_cast<std::uint32_t>(n) : kNowhere);
  }
  for (std::size_t n = 0; drawn_ == 0 && n < mesh.nodes.size(); ++n) {
    of_nodes_.insert(of_nodes_.end(), {static_cast<std::uint32_t>(n), parents_[n]});
  }
  for (Index e = 0; e < static_cast<Index>(elements_); ++e) {
    const auto at = static_cast<std::size_t>(e);
    const bool was_gone = (shows_[at] & shaders::kGone) != 0;
    if (was_gone != (gone[at] != 0)) {
      shows_[at] ^= shaders::kGone;
      touch(e);
    }
    const auto now = corners_now(e);
    if (now == corners_[at] && drawn_ != 0) continue;
    if (now != corners_[at]) touch(e);
    corners_[at] = now;
    for (std::size_t a = 0; a < 4; ++a) {
      const auto node = static_cast<std::size_t>(now[a]);
      const auto parent = static_cast<std::uint32_t>(mesh.tets[at][a]);
      if (parents_[node] == parent && (drawn_ != 0 || node < mesh.nodes.size())) continue;
      parents_[node] = parent;
      of_nodes_.insert(of_nodes_.end(), {static_cast<std::uint32_t>(node), parent});
    }
  }
}

shaders::SurfaceChangesPush SurfaceWriter::collect(const Surface& surface) {
  shaders::SurfaceChangesPush push{};
  list_.clear();
  of_nodes_.clear();
  if (surface.version() != drawn_) {
    follow_triangles(surface);
    follow_elements();
  }
  push.triangles = static_cast<std::uint32_t>(list_.size() / shaders::kTriangleWords);
  push.elements = static_cast<std::uint32_t>(touched_.size());
  push.nodes = static_cast<std::uint32_t>(of_nodes_.size() / shaders::kNodeWords);
  push.triangles_at = triangles_.at;
  push.triangles_stride = triangles_.stride;
  push.facts_at = facts_.at;
  push.facts_stride = facts_.stride;
  push.values = values_.stride > 0 ? 1 : 0;
  for (Index e : touched_) {
    const auto at = static_cast<std::size_t>(e);
    is_touched_[at] = 0;
    list_.insert(list_.end(), {static_cast<std::uint32_t>(e), shows_[at]});
    for (Index n : corners_[at]) list_.push_back(static_cast<std::uint32_t>(n));
  }
  touched_.clear();
  list_.insert(list_.end(), of_nodes_.begin(), of_nodes_.end());
  return push;
}

void SurfaceWriter::write_displacement(std::size_t nodes) {
  if (displacement_) return;
  const auto moved = simulation_.displacement();
  wide_.assign(4 * nodes, 0.0);
  for (std::size_t n = 0; n < nodes; ++n) {
    std::copy_n(moved[n].data(), 3, wide_.begin() + static_cast<std::ptrdiff_t>(4 * n));
  }
  write_wide(kernels_, own_displacement_, wide_);
}

/// Of a simulation elsewhere: maximum shear and ratio to yield of all elements, zeros before a
/// step.
void SurfaceWriter::write_stress() {
  if (!values_kernel_ || displacement_) return;
  const Problem& problem = simulation_.problem();
  const YieldMeasure measure = strength_measure(problem.scene().fracture);
  stresses_.assign(elements_, {});
  const std::vector<Voigt> stress =
      simulation_.backend().needs().stress ? simulation_.stress() : std::vector<Voigt>{};
  for (std::size_t e = 0; e < stress.size(); ++e) {
    const auto element = static_cast<Index>(e);
    stresses_[e][2] = static_cast<float>(max_shear(stress[e]));
    if (!problem.breakable(element)) continue;
    stresses_[e][3] = static_cast<float>(problem.yield_ratio(element, stress[e], measure));
  }
  own_stress_.write(std::span<const std::array<float, 4>>(stresses_));
}

shaders::SurfaceValuesPush SurfaceWriter::values_push(const Surface& surface) const {
  const Problem& problem = simulation_.problem();
  shaders::SurfaceValuesPush push{};
  push.count = static_cast<std::uint32_t>(surface.triangles().size());
  push.values_at = values_.at;
  push.values_stride = values_.stride;
  push.stress = stress_         ? shaders::kOfDevice
                : displacement_ ? shaders::kNoStress
                                : shaders::kOfHost;
  push.measure = static_cast<std::uint32_t>(strength_measure(problem.scene().fracture));
  push.finite = problem.finite() ? 1 : 0;
  return push;
}

void SurfaceWriter::record(VkCommandBuffer commands, const Surface& surface) {
  const auto nodes = static_cast<std::uint32_t>(surface.node_count());
  make_room(nodes);
  write_displacement(nodes);
  write_stress();
  const shaders::SurfaceChangesPush changes = collect(surface);
  if (!list_.empty() && list_.size() > changes_room_) {
    changes_binding_.reset();
    changes_room_ = std::max(list_.size(), 2 * changes_room_);
    changes_ = Buffer(device_, 4 * changes_room_, Placement::sent);
  }
  if (!list_.empty()) {
    if (!changes_binding_) bind_changes();
    changes_.write(std::span<const std::uint32_t>(list_));
  }
  vulkan::HostCommands out(device_, commands);
  if (!list_.empty()) {
    out.dispatch(*changes_binding_, changes,
                 groups_for(std::max({changes.triangles, changes.elements, changes.nodes})));
    out.barrier();
  }
  out.dispatch(
      *points_binding_,
      shaders::SurfacePointsPush{nodes, places_.at, places_.stride, normals_.at, normals_.stride},
      groups_for(nodes));
  if (skin_binding_) {
    out.dispatch(*skin_binding_,
                 shaders::SurfacePointsPush{vertices_, skin_.at, skin_.stride, skin_lives_.at,
                                            skin_lives_.stride},
                 groups_for(vertices_));
  }
  if (values_binding_) {
    const shaders::SurfaceValuesPush values = values_push(surface);
    out.dispatch(*values_binding_, values, groups_for(values.count));
  }
  out.end();
  drawn_ = surface.version();
}

}  // namespace sunder::gpu
