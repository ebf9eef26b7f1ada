// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sunder::app::system {

/// To be called first: the command line's words in UTF-8, the program's name first. From here on a
/// file over the size limit is an error of that write and not the program's end, and a console
/// shows UTF-8.
[[nodiscard]] std::vector<std::string> start_process(int argc, const char* const* argv);

/// The number of this process among those of the machine.
[[nodiscard]] long process_id() noexcept;
/// Of all its threads together [s].
[[nodiscard]] double processor_seconds() noexcept;

/// Whether stderr is a terminal that takes the sequences of VT100: a line can be written again.
[[nodiscard]] bool error_is_terminal() noexcept;
/// To stderr past the streams, whose locks a thread that was left behind may hold.
void write_error(std::string_view text) noexcept;

/// The number of the thread that asks.
[[nodiscard]] long thread_id() noexcept;
/// The other threads of this process get a quarter of what a processor gives to those kept, where
/// they compete for it.
void lower_priority_of_others(const std::vector<long>& kept) noexcept;
/// Never returns; another thread ends the program.
[[noreturn]] void stay() noexcept;

}  // namespace sunder::app::system
