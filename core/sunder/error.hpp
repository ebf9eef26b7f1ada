// SPDX-License-Identifier: Apache-2.0
// Typed errors. Every message is one sentence that names the offending place and value and says
// what is allowed. Set-up errors are thrown; numerical outcomes of a frame are reported in structs.
#pragma once

#include <stdexcept>
#include <string>

#include "sunder/in_quotes.hpp"

namespace sunder {

/// Base of all errors thrown by the library; `exit_code` is the program's exit code for it. The
/// message is one line whatever it quotes.
class Error : public std::runtime_error {
 public:
  Error(int exit_code, const std::string& message)
      : std::runtime_error(one_line(message)), exit_code_(exit_code) {}
  [[nodiscard]] int exit_code() const noexcept { return exit_code_; }

 private:
  int exit_code_;
};

/// A function was called in the wrong order or with arguments that do not fit: exit code 2.
class UsageError : public Error {
 public:
  explicit UsageError(const std::string& message) : Error(2, message) {}
};

/// What is wrong with a scene or a mesh. One value per rule, so that callers can react to it.
enum class InputFault {
  unreadable_file,       ///< missing, a directory, truncated, not of the stated format
  syntax,                ///< the scene is not TOML 1.0
  unknown_key,           ///< a key or an enumeration value that the schema does not know
  missing_key,           ///< a required key is absent
  wrong_type,            ///< a value of another type or array length than the schema's
  out_of_range,          ///< a number outside what is allowed, NaN and infinity included
  unknown_name,          ///< a volume, surface or crack that does not exist
  duplicate_name,        ///< the same name twice
  empty_selection,       ///< a selection that selects nothing
  bad_id,                ///< a node or element id outside the mesh
  no_tetrahedra,         ///< a mesh without a single tetrahedron
  inverted_element,      ///< negative volume (of validate(); Problem turns it)
  degenerate_element,    ///< zero volume or a repeated node
  no_material,           ///< a volume without material
  unsupported_body,      ///< rigid modes left in a body that is held or driven
  load_on_held_node,     ///< a force on a dof that a grip holds
  conflicting_supports,  ///< two grips prescribe the same dof
  too_large,             ///< sizes beyond what the index type or the memory at hand can hold
};

/// Bad input: exit code 3.
class InputError : public Error {
 public:
  InputError(InputFault fault, const std::string& message) : Error(3, message), fault_(fault) {}
  [[nodiscard]] InputFault fault() const noexcept { return fault_; }

 private:
  InputFault fault_;
};

/// No such device, backend or route on this machine: exit code 4.
class DeviceError : public Error {
 public:
  explicit DeviceError(const std::string& message) : Error(4, message) {}
};

/// The device stopped answering in the middle of its work; what it held is gone.
class DeviceLost : public DeviceError {
 public:
  using DeviceError::DeviceError;
};

/// A computation that cannot keep its promise; says where and how far it got: exit code 5.
class NumericalError : public Error {
 public:
  explicit NumericalError(const std::string& message) : Error(5, message) {}
};

}  // namespace sunder
