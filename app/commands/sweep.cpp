// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <iostream>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "app/commands/commands.hpp"
#include "app/commands/in_folder.hpp"
#include "app/commands/progress.hpp"
#include "app/commands/waiting.hpp"
#include "app/output/text.hpp"
#include "app/sweep/csv.hpp"
#include "app/sweep/order.hpp"
#include "app/sweep/outcome.hpp"
#include "app/sweep/parts.hpp"
#include "app/sweep/table.hpp"
#include "app/sweep/variants.hpp"
#include "sunder/backends.hpp"

namespace sunder::app {
namespace {

using namespace sweep;
using Clock = std::chrono::steady_clock;

// A signal waits so long for the runs in work to end; then the sweep is ended without them.
constexpr std::chrono::milliseconds kSweepGrace{500};

double seconds_of_sweep_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void write_tables(ResultFolder& folder, const Description& sweep, const Rows& rows,
                  const std::string& note) {
  folder.write("sweep.csv", sweep_csv(sweep, rows));
  folder.write("sweep.html", sweep_html(sweep, rows, note));
}

/// The first of them by number that has failed, or the end.
Rows::const_iterator first_failed(const Rows& rows) {
  return std::ranges::find_if(rows, [](const auto& row) { return exit_code_of(row.second) != 0; });
}

int exit_code_of_all(const Rows& rows) {
  const auto first = first_failed(rows);
  return first == rows.end() ? 0 : exit_code_of(first->second);
}

long long failed_count(const Rows& rows) {
  return std::ranges::count_if(rows, [](const auto& row) { return exit_code_of(row.second) != 0; });
}

/// The runs of a folder: threads compute them and hand their rows in. Where a signal comes and they
/// do not end by themselves, another thread writes the tables of what is there. `turn_` guards what
/// they share.
class Sweep {
 public:
  Sweep(const SweepArguments& arguments, Variants& variants, const Checked& checked,
        Description description, ResultFolder& folder, Rows done, Interruption& interruption)
      : arguments_(arguments),
        variants_(variants),
        description_(std::move(description)),
        folder_(folder),
        interruption_(interruption),
        before_(static_cast<RunIndex>(done.size())),
        order_(runs_to_do(description_.axes, description_.part, done, checked.changes_body)),
        rows_(std::move(done)),
        prepared_(prepared_bodies(static_cast<std::size_t>(arguments.jobs) + 1)),
        progress_(static_cast<int>(order_.size()), !arguments.quiet, "failed", "run"),
        file_(folder.path(), before_ == 0) {}

  int carry_out();

 private:
  void compute();
  void work();
  void hand_in(Outcome outcome);
  int end();
  int end_without_computing();
  void print_summary(long long failed) const;

  const SweepArguments& arguments_;
  Variants& variants_;
  const Description description_;
  ResultFolder& folder_;
  Interruption& interruption_;
  const RunIndex before_;  // runs done when it began
  const std::vector<RunIndex> order_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> given_up_{false};
  std::mutex turn_;
  Rows rows_;
  int failed_ = 0;  // of this session
  std::exception_ptr failure_;
  std::shared_ptr<cpu_reference::PreparedBodies> prepared_;
  const Clock::time_point start_ = Clock::now();
  Progress progress_;
  RowFile file_;
};

void Sweep::hand_in(Outcome outcome) {
  const std::lock_guard turn(turn_);
  file_.append(outcome.row);
  if (exit_code_of(outcome.row) != 0) ++failed_;
  rows_.emplace(outcome.run, std::move(outcome.row));
  progress_.update(static_cast<int>(rows_.size()) - static_cast<int>(before_), failed_);
}

void Sweep::work() {
  const auto stop = [this] { return interruption_.requested() || given_up_.load(); };
  try {
    for (std::size_t i; !stop() && (i = next_++) < order_.size();) {
      const RunIndex run = order_[i];
      auto outcome = sweep::compute(
          run, [&] { return variants_.problem(places_of(description_.axes, run)); }, prepared_,
          description_.instruments, stop);
      if (outcome) hand_in(std::move(*outcome));
    }
  } catch (...) {
    given_up_ = true;
    const std::lock_guard turn(turn_);
    if (!failure_) failure_ = std::current_exception();
  }
}

void Sweep::compute() {
  std::vector<std::thread> threads;
  const auto jobs = std::min(static_cast<std::size_t>(arguments_.jobs), order_.size());
  for (std::size_t job = 1; job < jobs; ++job) threads.emplace_back([this] { work(); });
  work();
  for (std::thread& thread : threads) thread.join();
}

int Sweep::carry_out() {
  const Expecting computing(
      interruption_,
      {"", [] { return false; }, [this] { return end_without_computing(); }, kSweepGrace});
  compute();
  interruption_.claim();
  return end();
}

/// On another thread than those that compute, which are left behind.
int Sweep::end_without_computing() {
  turn_.lock();  // for good
  return end();
}

int Sweep::end() {
  progress_.finish();
  const RunIndex all = description_.part.count(run_count(description_.axes));
  const auto done = static_cast<RunIndex>(rows_.size());
  const std::string missing =
      done < all ? grouped(all - done) + " of " + counted(all, "run") + " are missing" : "";
  if (failure_) std::rethrow_exception(failure_);
  write_tables(folder_, description_, rows_, missing);
  const bool signalled = interruption_.requested();
  folder_.release();
  if (signalled) {
    std::cerr << "sunder: interrupted after " << grouped(done) << " of " << counted(all, "run")
              << ": they are in " << folder_.path().string() << ", --resume goes on\n";
  }
  const long long failed = failed_count(rows_);
  print_summary(failed);
  return signalled ? kInterruptedExit : exit_code_of_all(rows_);
}

void Sweep::print_summary(long long failed) const {
  const double seconds = seconds_of_sweep_since(start_);
  const auto computed = static_cast<RunIndex>(rows_.size()) - before_;
  std::cout << counted(computed, "run") << " in " << rounded(seconds, 3) << " s by "
            << counted(arguments_.jobs, "job");
  if (before_ > 0) std::cout << ", " << grouped(before_) << " were there before";
  std::cout << ": " << counted(failed, "run") << " failed\n";
  if (const auto first = first_failed(rows_); first != rows_.end()) {
    std::cout << "  run " << first->first << ": " << csv_cells(first->second).back() << "\n";
  }
  std::cout << "  results in " << folder_.path().string()
            << ": sweep.csv sweep.html sweep.json sweep.rows" << std::endl;
}

/// What an earlier sweep has left in the folder, where this one goes on with it.
Rows done_before(const std::filesystem::path& folder, const Description& description, bool resume) {
  if (description.part.whole() && has_parts(folder)) {
    throw UsageError("--out: " + folder.string() +
                     " holds parts of a sweep; use --part or --merge, or name another folder");
  }
  const std::optional<Description> before = read_description(folder);
  if (!before) return {};
  const Rows rows = read_rows(folder, columns(description.instruments).size());
  if (!resume) {
    throw UsageError("--out: " + folder.string() + " holds a sweep with " +
                     counted(static_cast<long long>(rows.size()), "run") +
                     " done; go on with it by --resume, or name another folder");
  }
  if (const std::string other = difference(description, *before); !other.empty()) {
    throw UsageError("--resume: the sweep in " + folder.string() + " is another one: " + other);
  }
  if (before->part.i != description.part.i || before->part.n != description.part.n) {
    throw UsageError("--resume: the sweep in " + folder.string() + " is " + before->part.folder());
  }
  return rows;
}

Description describe(const SweepArguments& arguments, const Variants& variants,
                     const Checked& checked) {
  Description d;
  d.scene = arguments.scene.scene.string();
  d.text = variants.text();
  d.meshes = variants.fingerprints();
  d.overrides = variants.overrides();
  d.axes = variants.axes();
  d.instruments = checked.instruments;
  d.part = {arguments.part, arguments.parts};
  return d;
}

int merge(const SweepArguments& arguments, Interruption& interruption) {
  if (!has_parts(arguments.out)) {
    throw UsageError("--merge: there is no part of a sweep in " + arguments.out.string());
  }
  std::optional<ResultFolder> folder;
  const Expecting merging =
      in_folder(interruption, folder, arguments.out, "nothing was written to ");
  const Merged merged = merge_parts(arguments.out);
  if (!arguments.vary.empty()) {
    Description mine = merged.sweep;
    mine.axes = parse_axes(arguments.vary);
    if (const std::string other = difference(mine, merged.sweep); !other.empty()) {
      throw UsageError("--merge: the sweep in " + arguments.out.string() +
                       " is another one: " + other);
    }
  }
  std::string note;
  for (const std::string& missing : merged.missing) {
    note += (note.empty() ? "" : "; ") + missing;
    std::cerr << "sunder: warning: " << missing << "\n";
  }
  interruption.claim();
  write_tables(*folder, merged.sweep, merged.rows, note);
  interruption.over(0);
  std::cout << grouped(static_cast<long long>(merged.rows.size())) << " of "
            << counted(run_count(merged.sweep.axes), "run") << " in "
            << (arguments.out / "sweep.csv").string() << ", "
            << counted(failed_count(merged.rows), "run") << " failed" << std::endl;
  return 0;
}

}  // namespace

int sweep_scene(const SweepArguments& arguments, Interruption& interruption) {
  if (arguments.merge) return merge(arguments, interruption);
  Variants variants(arguments.scene.scene, overrides_of(arguments.scene),
                    parse_axes(arguments.vary));
  std::optional<Checked> checked;
  {
    const Waiting waiting("looking at the values", !arguments.quiet);
    checked = check_values(variants);
  }
  const Description description = describe(arguments, variants, *checked);
  const std::filesystem::path out =
      description.part.whole() ? arguments.out : arguments.out / description.part.folder();
  std::optional<ResultFolder> folder;
  const Expecting preparing = in_folder(interruption, folder, out, "nothing was computed in ");
  if (!arguments.quiet) {
    for (const std::string& warning : variants.warnings()) {
      std::cerr << "sunder: warning: " << warning << "\n";
    }
    if (folder->warning()) std::cerr << "sunder: warning: " << *folder->warning() << "\n";
  }
  Rows done = done_before(out, description, arguments.resume);
  folder->write("sweep.json", description.json());
  Sweep runs(arguments, variants, *checked, description, *folder, std::move(done), interruption);
  const int exit_code = runs.carry_out();
  // Destructors wait for threads that compute what nobody wants any more.
  if (exit_code == kInterruptedExit) interruption.leave(exit_code);
  interruption.over(exit_code);
  return exit_code;
}

}  // namespace sunder::app
