// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sunder/in_quotes.hpp"
#include "sunder/scene.hpp"

namespace sunder {

/// As messages name instrument i: by its name, or its number.
inline std::string instrument_name(const Instrument& instrument, std::size_t i) {
  return "instrument " + (instrument.name.empty() ? std::to_string(i) : in_quotes(instrument.name));
}

}  // namespace sunder
