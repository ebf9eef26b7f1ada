// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "app/input/nearest.hpp"
#include "app/inputs/inputs.hpp"
#include "app/output/text.hpp"
#include "sunder/error.hpp"
#include "sunder/simulation.hpp"

namespace sunder::app {
namespace {

class Resolver {
 public:
  Resolver(const Problem& problem, std::string place)
      : problem_(problem), place_(std::move(place)) {}

  void operator()(input::Drive& drive) const { drive.index = instrument(drive.instrument); }

  void operator()(input::Turn& turn) const {
    turn.index = instrument(turn.instrument);
    const auto* grip = std::get_if<Grip>(&problem_.scene().instruments[turn.index].action);
    if (grip && grip->rigid) return;
    fail("instrument " + in_quotes(turn.instrument) +
         " cannot be turned; only a grip with rigid = true can");
  }

  void operator()(input::Remove& remove) const {
    for (const Index e : remove.elements) {
      if (e < problem_.tet_count()) continue;
      fail("there is no element " + std::to_string(e) + "; the mesh has " +
           std::to_string(problem_.tet_count()) + ", from 0 on");
    }
  }

  void operator()(input::Grasp& grasp) const {
    for (const Index n : grasp.nodes) {
      if (n < problem_.node_count()) continue;
      fail("there is no node " + std::to_string(n) + "; the mesh has " +
           std::to_string(problem_.node_count()) + ", from 0 on");
    }
  }

  void operator()(input::Pose& pose) const { of_a_host(pose.grip); }
  /// A grip of the scene lets go too.
  void operator()(input::Release& release) const {
    const auto& all = problem_.scene().instruments;
    if (static_cast<std::size_t>(release.grip) >= all.size() ||
        std::holds_alternative<Grip>(all[static_cast<std::size_t>(release.grip)].action)) {
      return;
    }
    fail("instrument " + std::to_string(release.grip) +
         " holds nothing that it could let go; drive its force to 0");
  }

  void operator()(input::Colour& colour) const {
    const auto& name = field_names()[static_cast<std::size_t>(colour.field)];
    const auto refuse = [&](const std::string& why) {
      fail("the body cannot be coloured by " + name + ": " + why);
    };
    const bool of_stress = colour.field == Field::stress || colour.field == Field::yield;
    if (of_stress && !needs_of(problem_).stress) {
      refuse("the scene leaves stress out; name it in output.fields, or take strain");
    }
    if (colour.field != Field::yield) return;
    for (Index e = 0; e < problem_.tet_count(); ++e) {
      if (problem_.breakable(e)) return;
    }
    refuse("no material has a yield stress; take stress");
  }

  template <class Other>
  void operator()(Other&) const {}

 private:
  void of_a_host(int grip) const {
    const auto count = static_cast<int>(problem_.scene().instruments.size());
    if (grip >= count) return;
    fail("grip " + std::to_string(grip) +
         " is an instrument of the scene; those that are grasped " + "have numbers from " +
         std::to_string(count) + " on");
  }

  [[nodiscard]] std::size_t instrument(const std::string& name) const {
    std::vector<std::string> names;
    const auto& all = problem_.scene().instruments;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].name == name) return i;
      names.push_back(all[i].name);
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (name == std::to_string(i)) return i;
    }
    if (names.empty()) fail("the scene has no instrument that could be " + in_quotes(name));
    fail("the scene has no instrument " + in_quotes(name) + "; it has " +
         quoted_list(names, "and"));
  }

  [[noreturn]] void fail(const std::string& sentence) const {
    throw InputError(InputFault::out_of_range, place_ + sentence);
  }

  const Problem& problem_;
  std::string place_;
};

/// By its number where a line cannot hold its name.
std::string name_of(const std::string& name, std::size_t index) {
  const bool odd = std::ranges::any_of(
      name, [](char c) { return c == '"' || static_cast<unsigned char>(c) < ' '; });
  return odd ? std::to_string(index) : "\"" + name + "\"";
}

std::string numbers(const Vec3& v) {
  return number(v.x()) + " " + number(v.y()) + " " + number(v.z());
}

}  // namespace

void resolve(Inputs& inputs, const Problem& problem) {
  for (Input& i : inputs.list) {
    if (changes_body(i)) return;
    resolve(inputs, i, problem);
  }
}

void resolve(const Inputs& inputs, Input& input, const Problem& problem) {
  std::visit(Resolver(problem, inputs.at(input)), input.what);
}

bool changes_body(const Input& input) {
  return std::holds_alternative<input::Set>(input.what) ||
         std::holds_alternative<input::Open>(input.what);
}

std::string text_of(const input::Drive& drive) {
  return std::string(drive.further ? "move" : "drive") + " " +
         name_of(drive.instrument, drive.index) + " " + numbers(drive.value);
}

std::string text_of(const input::Turn& turn) {
  return "turn " + name_of(turn.instrument, turn.index) + " " + numbers(turn.rotation);
}

std::string text_of(const input::Remove& remove) {
  std::string text = "remove";
  for (const Index e : remove.elements) text += " " + std::to_string(e);
  return text;
}

std::string text_of(const input::Grasp& grasp) {
  std::string text = "grasp";
  if (grasp.nodes.empty()) {
    text += " " + numbers(grasp.near) + " " + number(grasp.radius);
  } else {
    text += " nodes";
    for (const Index n : grasp.nodes) text += " " + std::to_string(n);
  }
  return text + (grasp.rigid ? " rigid" : "");
}

std::string text_of(const input::Pose& pose) {
  std::string text = "pose " + std::to_string(pose.grip) + " " + numbers(pose.position);
  if (pose.quaternion == input::Pose().quaternion) return text;
  for (const double part : pose.quaternion) text += " " + number(part);
  return text;
}

std::string text_of(const input::Release& release) {
  return "release " + std::to_string(release.grip);
}

std::string text_of(const input::Cut& cut) {
  std::string text = "cut";
  for (const Vec3& p : cut.edge) text += " " + numbers(p);
  return text;
}

std::string text_of(const input::Step& step) {
  return step.count == 1 ? "step" : "step " + std::to_string(step.count);
}

}  // namespace sunder::app
