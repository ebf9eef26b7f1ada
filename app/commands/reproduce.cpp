// SPDX-License-Identifier: Apache-2.0
#include "app/reproduce/reproduce.hpp"

#include <cstdio>
#include <iostream>
#include <optional>

#include "app/commands/commands.hpp"
#include "app/commands/in_folder.hpp"
#include "app/output/text.hpp"
#include "app/reproduce/notch_mesh.hpp"
#include "app/system/process.hpp"

namespace sunder::app {
namespace {

/// One line that renews itself on a terminal, a line per task elsewhere.
class TaskLine {
 public:
  explicit TaskLine(bool shown) : shown_(shown), terminal_(system::error_is_terminal()) {}
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

int reproduce_paper(const ReproduceArguments& arguments, Interruption& interruption) {
  std::optional<ResultFolder> folder;
  const Expecting working = in_folder(interruption, folder, arguments.out,
                                      "nothing was written to ", reproduce::remove_temporary_files);
  if (folder->warning()) std::cerr << "sunder: warning: " << *folder->warning() << "\n";
  const TaskLine line(!arguments.quiet);
  const reproduce::Study study = reproduce::carry_out_study(
      {arguments.quick}, arguments.backend, [] { return false; },  // a signal does not ask
      [&](const std::string& what, std::size_t done, std::size_t all) {
        line.show(what, done, all);
      });
  line.finish();
  interruption.claim();
  const auto files = reproduce::write_study(study, *folder);
  const bool signalled = interruption.requested();
  interruption.over(0);
  print_verdicts(study);
  std::cout << counted(static_cast<long long>(files.size()), "file") << " in "
            << arguments.out.string() << " after " << rounded(study.seconds, 3) << " s: open "
            << (arguments.out / "index.html").string() << std::endl;
  if (!signalled) return 0;
  std::cerr << "sunder: interrupted when all was computed: the results are complete\n";
  return kInterruptedExit;
}

}  // namespace sunder::app
