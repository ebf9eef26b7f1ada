// SPDX-License-Identifier: Apache-2.0
#include "sunder/report.hpp"

namespace sunder {

const char* to_string(Cause cause) {
  switch (cause) {
    case Cause::mss:
      return "mss";
    case Cause::sif:
      return "sif";
    case Cause::preset:
      return "preset";
    case Cause::script:
      return "script";
    case Cause::principal:
      return "principal";
    case Cause::parting:
      return "interface";
  }
  return "";
}

}  // namespace sunder
