// SPDX-License-Identifier: Apache-2.0
#include "frame/action_bytes.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <string>
#include <string_view>

#include "material/fibres.hpp"
#include "sunder/error.hpp"

namespace sunder {
namespace {

constexpr std::array<std::uint8_t, 8> kMark{'S', 'U', 'N', 'D', 'E', 'R', 'R', 'C'};
// 1: no grips and pushes of a host. 2: no faces that a blade has opened. 3: no warm-up.
constexpr std::uint32_t kFirstVersion = 1, kVersion = 4;
constexpr std::size_t kCheck = 8;  // bytes of the checksum, last

/// FNV-1a of 64 bits.
class Hash {
 public:
  void add(std::uint8_t byte) { value_ = (value_ ^ byte) * 0x100000001b3ULL; }
  void add(std::uint64_t value) {
    for (int i = 0; i < 8; ++i) add(static_cast<std::uint8_t>(value >> 8 * i & 0xff));
  }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(const Vec3& v) {
    for (int i = 0; i < 3; ++i) add(v[i]);
  }
  void add_count(std::size_t count) { add(std::uint64_t{count}); }
  void add_index(Index i) { add(static_cast<std::uint64_t>(static_cast<std::int64_t>(i))); }
  void add(std::string_view text) {
    add_count(text.size());
    for (char c : text) add(static_cast<std::uint8_t>(c));
  }
  void add(std::span<const Index> list) {
    add_count(list.size());
    for (Index i : list) add_index(i);
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

std::uint64_t checksum(std::span<const std::uint8_t> bytes) {
  Hash hash;
  for (std::uint8_t b : bytes) hash.add(b);
  return hash.value();
}

class Writer {
 public:
  void byte(std::uint8_t value) { bytes.push_back(value); }
  void number(std::uint64_t value, int size = 8) {
    for (int i = 0; i < size; ++i) byte(static_cast<std::uint8_t>(value >> 8 * i & 0xff));
  }
  void index(std::int64_t value) { number(static_cast<std::uint64_t>(value)); }
  void real(double value) { number(std::bit_cast<std::uint64_t>(value)); }
  void vector(const Vec3& v) {
    for (int i = 0; i < 3; ++i) real(v[i]);
  }
  std::vector<std::uint8_t> bytes;
};

[[noreturn]] void damaged() {
  throw InputError(InputFault::syntax,
                   "the recording is damaged: it has been cut short or changed");
}

class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : left_(bytes) {}
  std::uint64_t number(std::size_t size = 8) {
    if (left_.size() < size) damaged();
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value |= std::uint64_t{left_[i]} << 8 * i;
    left_ = left_.subspan(size);
    return value;
  }
  std::int64_t index() { return static_cast<std::int64_t>(number()); }
  double real() { return std::bit_cast<double>(number()); }
  Vec3 vector() {
    Vec3 v;
    for (int i = 0; i < 3; ++i) v[i] = real();
    return v;
  }
  /// Of things that take so many bytes each: no more than are there.
  std::size_t count(std::size_t each) {
    const std::uint64_t n = number();
    if (n > left_.size() / each) damaged();
    return static_cast<std::size_t>(n);
  }
  [[nodiscard]] bool done() const { return left_.empty(); }

 private:
  std::span<const std::uint8_t> left_;
};

void write(Writer& to, const Action::Drive& a) {
  to.number(a.instrument);
  to.vector(a.value);
}
void write(Writer& to, const Action::Turn& a) {
  to.number(a.instrument);
  to.vector(a.rotation);
}
void write(Writer& to, const Action::Attribute& a) { to.byte(a.wanted ? 1 : 0); }
void write(Writer& to, const Action::Velocity& a) {
  to.number(a.velocity.size());
  for (const Vec3& v : a.velocity) to.vector(v);
}
void write(Writer& to, const Action::Step& a) {
  to.byte(a.dt ? 1 : 0);
  to.real(a.dt.value_or(0));
  to.index(a.events);
  to.byte(a.by_time ? 1 : 0);
}
void write(Writer& to, const Action::Remove& a) {
  to.number(a.elements.size());
  for (Index e : a.elements) to.index(e);
}
void write(Writer& to, const std::vector<Index>& nodes) {
  to.number(nodes.size());
  for (Index n : nodes) to.index(n);
}
void write(Writer& to, const Action::Open& a) {
  to.number(a.faces.size());
  for (const auto& [face, place] : a.faces) {
    to.index(face.element);
    to.index(face.opposite);
    to.vector(place);
  }
}
void write(Writer& to, const Action::Grasp& a) {
  write(to, a.nodes);
  to.byte(a.rigid ? 1 : 0);
  to.vector(a.centre);
}
void write(Writer& to, const Action::Pose& a) {
  to.index(a.id);
  to.vector(a.position);
  for (const double q : a.quaternion) to.real(q);
}
void write(Writer& to, const Action::Release& a) { to.index(a.id); }
void write(Writer& to, const Action::Push& a) {
  write(to, a.nodes);
  to.vector(a.force);
}
void write(Writer& to, const Action::Move& a) {
  to.index(a.id);
  write(to, a.nodes);
  to.vector(a.force);
}
void write(Writer& to, const Action::Drop& a) { to.index(a.id); }
void write(Writer&, const Action::WarmUp&) {}

void read(Reader& from, Action::Drive& a) {
  a.instrument = static_cast<std::size_t>(from.number());
  a.value = from.vector();
}
void read(Reader& from, Action::Turn& a) {
  a.instrument = static_cast<std::size_t>(from.number());
  a.rotation = from.vector();
}
void read(Reader& from, Action::Attribute& a) { a.wanted = from.number(1) != 0; }
void read(Reader& from, Action::Velocity& a) {
  a.velocity.resize(from.count(3 * sizeof(double)));
  for (Vec3& v : a.velocity) v = from.vector();
}
void read(Reader& from, Action::Step& a) {
  const bool own = from.number(1) == 0;
  const double dt = from.real();
  if (!own) a.dt = dt;
  a.events = static_cast<int>(from.index());
  a.by_time = from.number(1) != 0;
}
void read(Reader& from, Action::Remove& a) {
  a.elements.resize(from.count(8));
  for (Index& e : a.elements) e = static_cast<Index>(from.index());
}
void read(Reader& from, std::vector<Index>& nodes) {
  nodes.resize(from.count(8));
  for (Index& n : nodes) n = static_cast<Index>(from.index());
}
void read(Reader& from, Action::Grasp& a) {
  read(from, a.nodes);
  a.rigid = from.number(1) != 0;
  a.centre = from.vector();
}
void read(Reader& from, Action::Pose& a) {
  a.id = static_cast<int>(from.index());
  a.position = from.vector();
  for (double& q : a.quaternion) q = from.real();
}
void read(Reader& from, Action::Release& a) { a.id = static_cast<int>(from.index()); }
void read(Reader& from, Action::Push& a) {
  read(from, a.nodes);
  a.force = from.vector();
}
void read(Reader& from, Action::Move& a) {
  a.id = static_cast<int>(from.index());
  read(from, a.nodes);
  a.force = from.vector();
}
void read(Reader& from, Action::Open& a) {
  a.faces.resize(from.count(2 * 8 + 3 * sizeof(double)));
  for (auto& [face, place] : a.faces) {
    face.element = static_cast<Index>(from.index());
    face.opposite = static_cast<int>(from.index());
    place = from.vector();
  }
}
void read(Reader& from, Action::Drop& a) { a.id = static_cast<int>(from.index()); }
void read(Reader&, Action::WarmUp&) {}

using What = decltype(Action::what);

template <std::size_t... I>
What of_kind(std::size_t kind, std::index_sequence<I...>) {
  What what;
  if (!((kind == I ? (what.emplace<I>(), true) : false) || ...)) damaged();
  return what;
}

void add_body(Hash& hash, const Problem& problem) {
  hash.add_count(problem.mesh().nodes.size());
  for (const Vec3& x : problem.mesh().nodes) hash.add(x);
  for (const auto& tet : problem.mesh().tets) hash.add(std::span<const Index>(tet));
  hash.add(problem.dofs());
  hash.add(problem.gripped_dofs());
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const Material& m = problem.material(e);
    const SmallStrain& elasticity = problem.small_strain(e);
    for (const double v :
         {elasticity.mu, elasticity.lambda, m.yield.value_or(-1), m.density.value_or(-1),
          m.toughness.value_or(-1), m.energy.value_or(-1)}) {
      hash.add(v);
    }
    hash.add(static_cast<std::uint8_t>(m.law));
    for (int i = 0; elasticity.fibres && i < elasticity.fibres->count; ++i) {
      const FibreFamily& f = elasticity.fibres->family[static_cast<std::size_t>(i)];
      hash.add(f.direction);
      hash.add(m.fibres[static_cast<std::size_t>(i)].yield_across.value_or(-1));
      for (const double v : {f.k1, f.k2, f.dispersion}) hash.add(v);
      const AlongFibres& linear = elasticity.fibres->linear;
      for (const double v : {linear.lambda, linear.alpha, linear.beta, linear.mu}) hash.add(v);
    }
    if (problem.guides_cracks() && !m.fibres.empty()) {
      hash.add(problem.fibre_direction(e, 0));
      hash.add(m.fibres.front().toughness_across.value_or(-1));
      hash.add(m.fibres.front().energy_across.value_or(-1));
    }
    // By element as in recordings that are older than the word.
    if (m.volume != MaterialVolume::element) hash.add(static_cast<std::uint8_t>(m.volume));
  }
  for (const Interface& i : problem.scene().interfaces) {
    for (const double v : {i.strength, i.energy, i.shear_ratio}) hash.add(v);
  }
}

void add_instruments(Hash& hash, const Problem& problem) {
  const auto& instruments = problem.scene().instruments;
  hash.add_count(instruments.size());
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    hash.add(std::span<const Index>(problem.instrument_nodes()[i].nodes));
    hash.add_count(instruments[i].action.index());
    if (const auto* pull = std::get_if<Pull>(&instruments[i].action)) hash.add(pull->force);
    if (const auto* grip = std::get_if<Grip>(&instruments[i].action)) {
      hash.add(grip->displacement);
      hash.add(grip->turn);
      hash.add(static_cast<std::uint8_t>(grip->rigid ? 1 : 0));
    }
    if (const auto* press = std::get_if<Press>(&instruments[i].action)) {
      hash.add(press->at);
      hash.add(press->force);
      hash.add_index(press->crack);
    }
    const auto& ramp = instruments[i].ramp;
    hash.add(ramp ? ramp->begin : -1.0);
    hash.add(ramp ? ramp->end : -1.0);
  }
}

void add_options(Hash& hash, const Scene& scene, bool live) {
  const FractureOptions& f = scene.fracture;
  for (const int word :
       {static_cast<int>(f.model), static_cast<int>(f.yield_measure), static_cast<int>(f.sigma0),
        static_cast<int>(f.crack_length), static_cast<int>(f.birth), static_cast<int>(f.sif),
        static_cast<int>(f.crack), static_cast<int>(f.stress), f.max_events, f.max_new_nodes,
        scene.steps, live ? 1 : 0}) {
    hash.add_index(word);
  }
  for (const double v : {f.alpha, f.averaging, scene.solver.tolerance}) hash.add(v);
  hash.add(scene.gravity);
  if (!scene.dynamics) return;
  const Dynamics& d = *scene.dynamics;
  for (const double v : {d.time_step, d.mass_damping, d.stiffness_damping}) hash.add(v);
  hash.add_index(d.max_iterations);
}

}  // namespace

std::uint64_t fingerprint(const Problem& problem, const BackendInfo& backend, bool live) {
  Hash hash;
  add_body(hash, problem);
  add_instruments(hash, problem);
  for (const auto* lists : {&problem.crack_elements(), &problem.removal_elements()}) {
    hash.add_count(lists->size());
    for (const auto& elements : *lists) hash.add(std::span<const Index>(elements));
  }
  for (const ScriptedRemoval& removal : problem.scene().removals) hash.add_index(removal.step);
  add_options(hash, problem.scene(), live);
  for (const std::string* word :
       {&backend.backend, &backend.precision, &backend.route, &backend.update}) {
    hash.add(*word);
  }
  return hash.value();
}

std::vector<std::uint8_t> to_bytes(std::span<const std::shared_ptr<const Action>> actions,
                                   std::uint64_t body) {
  Writer to;
  to.bytes.assign(kMark.begin(), kMark.end());
  to.number(kVersion, 4);
  to.number(body);
  to.number(actions.size());
  for (const auto& action : actions) {
    to.byte(static_cast<std::uint8_t>(action->what.index()));
    to.byte(static_cast<std::uint8_t>((action->failed ? 1 : 0) + (action->broke ? 2 : 0)));
    std::visit([&](const auto& what) { write(to, what); }, action->what);
  }
  to.number(checksum(to.bytes));
  return std::move(to.bytes);
}

std::vector<std::shared_ptr<const Action>> from_bytes(std::span<const std::uint8_t> bytes,
                                                      std::span<const std::uint64_t> bodies) {
  if (bytes.size() < kMark.size() || !std::ranges::equal(bytes.first(kMark.size()), kMark)) {
    throw InputError(InputFault::syntax, "these bytes are no recording of sunder");
  }
  Reader head(bytes.subspan(kMark.size()));
  const std::uint64_t version = head.number(4);
  if (version < kFirstVersion || version > kVersion) {
    throw InputError(InputFault::syntax, "the recording is of version " + std::to_string(version) +
                                             "; this library reads versions " +
                                             std::to_string(kFirstVersion) + " to " +
                                             std::to_string(kVersion));
  }
  if (bytes.size() < kMark.size() + 4 + kCheck) damaged();
  const auto told = bytes.first(bytes.size() - kCheck);
  if (checksum(told) != Reader(bytes.last(kCheck)).number()) damaged();
  Reader from(told.subspan(kMark.size() + 4));
  if (std::ranges::find(bodies, from.number()) == bodies.end()) {
    throw InputError(InputFault::unknown_name,
                     "the recording is of another body, scene or solver than this simulation");
  }
  std::vector<std::shared_ptr<const Action>> actions;
  const std::size_t count = from.count(2);
  actions.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    Action action{of_kind(static_cast<std::size_t>(from.number(1)),
                          std::make_index_sequence<std::variant_size_v<What>>())};
    const std::uint64_t flags = from.number(1);
    action.failed = (flags & 1) != 0;
    action.broke = (flags & 2) != 0;
    std::visit([&](auto& what) { read(from, what); }, action.what);
    actions.push_back(std::make_shared<const Action>(std::move(action)));
  }
  if (!from.done()) damaged();
  return actions;
}

}  // namespace sunder
