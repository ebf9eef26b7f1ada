// SPDX-License-Identifier: Apache-2.0
#include "app/reproduce/reproduce.hpp"

#include <unistd.h>

#include <cstdio>
#include <iostream>

#include "app/commands/commands.hpp"
#include "app/commands/interrupt.hpp"
#include "app/output/result_file.hpp"
#include "app/output/text.hpp"

namespace sunder::app {
namespace {

/// One line that renews itself on a terminal, a line per task elsewhere.
class TaskLine {
 public:
  explicit TaskLine(bool shown) : shown_(shown), terminal_(::isatty(STDERR_FILENO) == 1) {}
  ~TaskLine() { finish(); }
  void show(const std::string& what, std::size_t done, std::size_t all) const {
    if (!shown_) return;
    const std::string text =
        "chapter " + std::to_string(done + 1) + "/" + std::to_string(all) + ": " + what;
    std::fprintf(stderr, terminal_ ? "\r%s\033[K" : "%s\n", text.c_str());
    std::fflush(stderr);
  }
  void finish() const {
    if (shown_ && terminal_) std::fputs("\r\033[K", stderr);
  }

 private:
  bool shown_, terminal_;
};

void print_verdicts(const reproduce::Study& study) {
  for (const reproduce::Chapter& chapter : study.chapters)
    for (const reproduce::Statement& s : chapter.statements)
      std::cout << "  " << s.id << " " << s.text << " (" << s.by
                << "): " << to_string(s.judgement.verdict) << "\n";
}

}  // namespace

int reproduce_paper(const ReproduceArguments& arguments) {
  const InterruptGuard guard;
  make_result_folder(arguments.out);
  const TaskLine line(!arguments.quiet);
  try {
    const reproduce::Study study =
        reproduce::carry_out_study({arguments.quick}, arguments.backend, InterruptGuard::requested,
                                   [&](const std::string& what, std::size_t done, std::size_t all) {
                                     line.show(what, done, all);
                                   });
    line.finish();
    const auto files = reproduce::write_study(study, arguments.out);
    print_verdicts(study);
    std::cout << counted(static_cast<long long>(files.size()), "file") << " in "
              << arguments.out.string() << " after " << rounded(study.seconds, 3) << " s: open "
              << (arguments.out / "index.html").string() << std::endl;
    return 0;
  } catch (const reproduce::Interrupted&) {
    line.finish();
    std::cerr << "sunder: interrupted: nothing was written to " << arguments.out.string() << "\n";
    return kInterruptedExit;
  }
}

}  // namespace sunder::app
