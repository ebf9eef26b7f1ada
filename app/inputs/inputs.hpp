// SPDX-License-Identifier: Apache-2.0
// What a hand does to a body while a run goes on, and how it looks at it: plain text, one input a
// line (docs/view.md "Inputs").
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "sunder/problem.hpp"

namespace sunder::app {

/// Of a picture [px].
struct PictureSize {
  int width = 960, height = 720;
};

enum class Field { stress, yield, strain, displacement };
[[nodiscard]] const std::vector<std::string>& field_names();  ///< in the order of Field

namespace input {
// What is done to the body.
struct Drive {
  std::string instrument;
  Vec3 value;             ///< force [N] or displacement [mm], from the next step on
  bool further = false;   ///< added to what it is
  std::size_t index = 0;  ///< of the instrument, by resolve()
};
struct Turn {
  std::string instrument;
  Vec3 rotation;  ///< [deg]
  std::size_t index = 0;
};
struct Remove {
  std::vector<Index> elements;
};
/// Takes hold of nodes, or of all within a radius of a place: a grip by the number that
/// Simulation::grasp gives it, the first one as many as the scene has instruments.
struct Grasp {
  std::vector<Index> nodes;  ///< empty: near
  Vec3 near = Vec3::Zero();  ///< [mm]
  double radius = 0;         ///< [mm]
  bool rigid = false;
  int grip = kNone;  ///< that it has become
};
/// Brings a grip to a place and a rotation since it took hold (x, y, z, w).
struct Pose {
  int grip = 0;
  Vec3 position = Vec3::Zero();  ///< [mm]
  std::array<double, 4> quaternion{0, 0, 0, 1};
};
struct Release {
  int grip = 0;
};
/// Places of a blade's edge, two points each [mm]: what it passes from one to the next is cut.
struct Cut {
  std::vector<Vec3> edge;
};
struct Step {
  int count = 1;
};
/// As many pictures, each after a step unless paused.
struct Frame {
  int count = 1;
};
// Going back.
struct Undo {
  int count = 1;
};
struct Redo {
  int count = 1;
};
struct Reset {};
// What is seen.
struct Pause {
  bool on = true;
};
/// Through all of the body along a line on the picture, from (0, 0) left above to (1, 1).
struct Stroke {
  std::vector<Vec2> line;
};
struct Camera {
  double azimuth = 0, elevation = 0;  ///< [deg] to the right of z and above it
  double zoom = 1;                    ///< 1: the body fits
};
struct Look {
  std::optional<Vec3> at;  ///< what is in the middle [mm]; none: the body
};
struct Colour {
  Field field = Field::stress;
  std::optional<double> maximum;  ///< end of the scale; none: by what is there
};
/// What lies on the side to which `normal` points, beyond `offset` [mm] along it, is left out.
struct Clip {
  std::optional<Vec3> normal;  ///< unit; none: nothing is left out
  double offset = 0;
};
struct Show {
  enum class What { wireframe, arrows, tips, fibres, text, pictures } what = What::wireframe;
  bool on = true;
};
// The body itself.
/// Keys of its scene, "KEY.PATH=VALUE" as --set takes it.
struct Set {
  std::vector<std::string> changes;
};
/// Another scene or mesh in its place.
struct Open {
  std::string file;
};
}  // namespace input

using InputAction =
    std::variant<input::Drive, input::Turn, input::Remove, input::Cut, input::Grasp, input::Pose,
                 input::Release, input::Step, input::Frame, input::Undo, input::Redo, input::Reset,
                 input::Pause, input::Stroke, input::Camera, input::Look, input::Colour,
                 input::Clip, input::Show, input::Set, input::Open>;

struct Input {
  int line = 0;  ///< from 1
  InputAction what;
};

struct Inputs {
  std::string source;  ///< the file: begins messages; empty: none
  std::vector<Input> list;

  /// Beginning of a message: "file:line: "; of inputs that are from no file there is none.
  [[nodiscard]] std::string at(const Input& input) const {
    return source.empty() ? "" : source + ":" + std::to_string(input.line) + ": ";
  }
  /// How many pictures they ask for.
  [[nodiscard]] int frames() const;
};

/// Throws InputError with file and line: a word that is no input, a value that is not allowed.
[[nodiscard]] Inputs parse_inputs(std::string_view text, const std::string& source);
/// The same of a file.
[[nodiscard]] Inputs read_inputs(const std::string& path);

/// Fills in what the names stand for. Throws InputError with file and line for an instrument or an
/// element that the problem does not have, and for a field that its scene does not compute. What
/// comes after a change of the body stays as it is: it is for the body that is there then.
void resolve(Inputs& inputs, const Problem& problem);
/// Of one input.
void resolve(const Inputs& inputs, Input& input, const Problem& problem);
/// Whether an input leaves another body.
[[nodiscard]] bool changes_body(const Input& input);

/// As parse_inputs() reads it, without a line's end; what is seen has no text.
[[nodiscard]] std::string text_of(const input::Drive& drive);
[[nodiscard]] std::string text_of(const input::Turn& turn);
[[nodiscard]] std::string text_of(const input::Remove& remove);
[[nodiscard]] std::string text_of(const input::Grasp& grasp);
[[nodiscard]] std::string text_of(const input::Pose& pose);
[[nodiscard]] std::string text_of(const input::Release& release);
[[nodiscard]] std::string text_of(const input::Cut& cut);
[[nodiscard]] std::string text_of(const input::Step& step);

}  // namespace sunder::app
