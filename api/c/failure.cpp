// SPDX-License-Identifier: Apache-2.0
#include "c/failure.hpp"

#include <array>
#include <cstring>
#include <new>
#include <stdexcept>

#include "c/status.hpp"
#include "sunder/error.hpp"

namespace sunder::c {
namespace {

thread_local std::array<char, kErrorText> last_text{};

sunder_status failed(sunder_status status, const char* text) noexcept {
  remember(text);
  return status;
}

}  // namespace

void remember(const char* text) noexcept {
  std::strncpy(last_text.data(), text, last_text.size() - 1);
}

const char* last_text_of_thread() noexcept { return last_text.data(); }

void not_finite(double value, std::ptrdiff_t at, const char* what) {
  std::string text = what;
  if (at >= 0) text += "[" + std::to_string(at) + "]";
  text += std::isnan(value) ? " = nan" : value > 0 ? " = inf" : " = -inf";
  throw Failure(SUNDER_ERROR_VALUE, text + " is not a finite number");
}

sunder_status status_of_exception() noexcept {
  try {
    throw;
  } catch (const Failure& e) {
    return failed(e.status(), e.what());
  } catch (const InputError& e) {
    return failed(SUNDER_ERROR_INPUT, e.what());
  } catch (const DeviceError& e) {
    return failed(SUNDER_ERROR_DEVICE, e.what());
  } catch (const NumericalError& e) {
    return failed(SUNDER_ERROR_NUMERICAL, e.what());
  } catch (const UsageError& e) {
    return failed(SUNDER_ERROR_ORDER, e.what());
  } catch (const std::bad_alloc&) {
    return failed(SUNDER_ERROR_MEMORY, "out of memory");
  } catch (const std::length_error&) {
    return failed(SUNDER_ERROR_MEMORY, "an array would be larger than memory can hold");
  } catch (const std::exception& e) {
    return failed(SUNDER_ERROR_INTERNAL, e.what());
  } catch (...) {
    return failed(SUNDER_ERROR_INTERNAL,
                  "something unknown was thrown, by the library or by a callback");
  }
}

}  // namespace sunder::c
