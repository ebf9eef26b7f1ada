// SPDX-License-Identifier: Apache-2.0
#include "app/inputs/inputs.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "app/input/file_bytes.hpp"
#include "app/input/nearest.hpp"
#include "app/inputs/words.hpp"
#include "app/system/utf8_path.hpp"
#include "sunder/error.hpp"

namespace sunder::app {
namespace {

constexpr std::size_t kLargestInputs = 256U << 20U;  // bytes; a recording of an hour is some MB

int count(Words& words, const std::string& what) {
  return words.left() ? words.whole("the number of " + what, 1) : 1;
}

InputAction read_remove(Words& words) {
  input::Remove remove;
  do {
    remove.elements.push_back(words.whole("an element to remove", 0));
  } while (words.left() > 0);
  return remove;
}

InputAction read_cut(Words& words) {
  input::Cut cut;
  do {
    cut.edge.push_back(words.vector("a point of the blade"));
  } while (words.left() > 0);
  if (cut.edge.size() < 4 || cut.edge.size() % 2 != 0) {
    words.fail("cut has " + std::to_string(cut.edge.size()) +
               " points; a blade takes two points for each place of its edge, and two places or "
               "more");
  }
  return cut;
}

InputAction read_grasp(Words& words) {
  input::Grasp grasp;
  if (words.peek() == "nodes") {
    words.take("");
    do {
      grasp.nodes.push_back(words.whole("a node to grasp", 0));
    } while (words.left() > 0 && words.peek() != "rigid");
  } else {
    grasp.near = words.vector("where to grasp, or nodes and their numbers,");
    grasp.radius = words.number("the radius of the grip [mm]");
    if (!(grasp.radius > 0)) words.fail("the radius of a grip must be above 0 mm");
  }
  grasp.rigid = words.left() > 0 && words.word("rigid or nothing", {"rigid"}) == 0;
  return grasp;
}

InputAction read_pose(Words& words) {
  input::Pose pose;
  pose.grip = words.whole("the grip's number", 0);
  pose.position = words.vector("the grip's place");
  if (words.left() == 0) return pose;
  bool turns = false;
  for (double& part : pose.quaternion) {
    part = words.number("the grip's quaternion, x y z w,");
    turns = turns || part != 0;
  }
  if (!turns) words.fail("the grip's quaternion is 0 0 0 0; of no turn it is 0 0 0 1");
  return pose;
}

InputAction read_stroke(Words& words) {
  input::Stroke stroke;
  do {
    const double x = words.number("x on the picture");
    const double y = words.number("y on the picture");
    if (!(x >= 0 && x <= 1 && y >= 0 && y <= 1)) {
      words.fail("a stroke leaves the picture; its points go from 0 0, left above, to 1 1");
    }
    stroke.line.emplace_back(x, y);
  } while (words.left() > 0);
  if (stroke.line.size() < 2) words.fail("a stroke takes two points or more");
  return stroke;
}

InputAction read_camera(Words& words) {
  input::Camera camera;
  camera.azimuth = words.number("the azimuth [deg]");
  camera.elevation = words.number("the elevation [deg]");
  if (words.left()) camera.zoom = words.number("the zoom");
  if (!(camera.zoom > 0)) words.fail("the zoom must be above 0; 1 shows all of the body");
  return camera;
}

InputAction read_look(Words& words) {
  if (words.peek() != "body") return input::Look{words.vector("the point to look at")};
  words.take("");
  return input::Look{};
}

InputAction read_colour(Words& words) {
  input::Colour colour;
  colour.field = static_cast<Field>(words.word("the field", field_names()));
  if (words.left() == 0) return colour;
  if (words.peek() == "auto") {
    words.take("");
    return colour;
  }
  colour.maximum = words.number("the end of the scale");
  if (!(*colour.maximum > 0)) words.fail("the end of the scale must be above 0, or auto");
  return colour;
}

InputAction read_clip(Words& words) {
  if (words.peek() == "off") {
    words.take("");
    return input::Clip{};
  }
  const Vec3 normal = words.vector("the normal of the clipping plane");
  const double offset = words.number("the offset of the clipping plane [mm]");
  if (!(normal.norm() > 0)) words.fail("the normal of the clipping plane is zero");
  return input::Clip{normal.normalized(), offset};
}

InputAction read_show(Words& words, input::Show::What what) {
  return input::Show{what, words.word("on or off", {"on", "off"}) == 0};
}

InputAction read_drive(Words& words, bool further) {
  input::Drive drive;
  drive.instrument = words.take("the instrument's name");
  drive.value = words.vector(further ? "how far" : "the value");
  drive.further = further;
  return drive;
}

InputAction read_turn(Words& words) {
  input::Turn turn;
  turn.instrument = words.take("the instrument's name");
  turn.rotation = words.vector("the rotation [deg]");
  return turn;
}

InputAction read_set(Words& words) {
  input::Set set;
  do {
    set.changes.push_back(words.take("a change, KEY.PATH=VALUE,"));
    const std::string& change = set.changes.back();
    if (change.find('=') == std::string::npos || change.front() == '=') {
      words.fail(in_quotes(change) +
                 " is no change of the scene; it is KEY.PATH=VALUE, such as "
                 "material.upper.young=0.1");
    }
  } while (words.left() > 0);
  return set;
}

struct Verb {
  const char* name;
  InputAction (*read)(Words& words);
};

using What = input::Show::What;
constexpr std::array kVerbs{
    Verb{"drive", [](Words& w) { return read_drive(w, false); }},
    Verb{"move", [](Words& w) { return read_drive(w, true); }},
    Verb{"turn", read_turn},
    Verb{"remove", read_remove},
    Verb{"cut", read_cut},
    Verb{"grasp", read_grasp},
    Verb{"pose", read_pose},
    Verb{"release",
         [](Words& w) -> InputAction { return input::Release{w.whole("the grip's number", 0)}; }},
    Verb{"stroke", read_stroke},
    Verb{"step", [](Words& w) -> InputAction { return input::Step{count(w, "steps")}; }},
    Verb{"frame", [](Words& w) -> InputAction { return input::Frame{count(w, "frames")}; }},
    Verb{"undo", [](Words& w) -> InputAction { return input::Undo{count(w, "actions")}; }},
    Verb{"redo", [](Words& w) -> InputAction { return input::Redo{count(w, "actions")}; }},
    Verb{"reset", [](Words&) -> InputAction { return input::Reset{}; }},
    Verb{"pause", [](Words&) -> InputAction { return input::Pause{true}; }},
    Verb{"go", [](Words&) -> InputAction { return input::Pause{false}; }},
    Verb{"set", read_set},
    Verb{
        "open",
        [](Words& w) -> InputAction { return input::Open{w.take("the file of a scene or mesh")}; }},
    Verb{"camera", read_camera},
    Verb{"look", read_look},
    Verb{"colour", read_colour},
    Verb{"clip", read_clip},
    Verb{"wireframe", [](Words& w) { return read_show(w, What::wireframe); }},
    Verb{"arrows", [](Words& w) { return read_show(w, What::arrows); }},
    Verb{"tips", [](Words& w) { return read_show(w, What::tips); }},
    Verb{"fibres", [](Words& w) { return read_show(w, What::fibres); }},
    Verb{"text", [](Words& w) { return read_show(w, What::text); }},
    Verb{"record", [](Words& w) { return read_show(w, What::pictures); }},
};

InputAction read_action(Words& words) {
  const std::string name = words.take("an input");
  std::vector<std::string> names;
  for (const Verb& verb : kVerbs) {
    if (name == verb.name) {
      const InputAction action = verb.read(words);
      words.end();
      return action;
    }
    names.emplace_back(verb.name);
  }
  const std::string close = nearest(name, names);
  words.fail(in_quotes(name) + " is no input" +
             (close.empty() ? "" : ", perhaps " + in_quotes(close) + " was meant") +
             "; allowed is " + quoted_list(names));
}

}  // namespace

const std::vector<std::string>& field_names() {
  static const std::vector<std::string> names{"stress", "yield", "strain", "displacement"};
  return names;
}

int Inputs::frames() const {
  int sum = 0;
  for (const Input& i : list) {
    if (const auto* frame = std::get_if<input::Frame>(&i.what)) sum += frame->count;
  }
  return sum;
}

Inputs parse_inputs(std::string_view text, const std::string& source) {
  Inputs inputs{source, {}};
  int number = 0;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    ++number;
    Words words(source + ":" + std::to_string(number) + ": ", text.substr(begin, end - begin));
    if (!words.empty()) inputs.list.push_back({number, read_action(words)});
    begin = end + 1;
  }
  return inputs;
}

Inputs read_inputs(const std::string& path) {
  return parse_inputs(read_file(system::utf8_path(path), kLargestInputs), path);
}

}  // namespace sunder::app
