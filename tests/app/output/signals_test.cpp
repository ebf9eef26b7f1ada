// SPDX-License-Identifier: Apache-2.0
// SIGINT and SIGTERM at any moment: while libraries load, a mesh is read, a body is prepared, a
// step is computed or a file is written.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <optional>
#include <random>
#include <regex>
#include <thread>

#include "app/commands/in_folder.hpp"
#include "app/output/program.hpp"
#include "app/output/whole_results.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

using namespace std::chrono_literals;

// A second is promised. Tests share their machine, so they count what the program computes in it:
// on one processor it is no more than the time that passes. bench/signals measures that.
constexpr double kLimit = 1.0;  // s

/// Waits until a started process is no longer this program's copy.
void wait_for_start(pid_t program) {
  const std::string exe = "/proc/" + std::to_string(program) + "/exe";
  for (int i = 0; i < 60000; ++i) {
    std::error_code error;
    if (std::filesystem::read_symlink(exe, error).filename() == "sunder-program") return;
    std::this_thread::sleep_for(200us);
  }
  FAIL() << "it has not started";
}

/// Of all threads of a process, so far [s].
double processor_seconds(pid_t process) {
  clockid_t clock{};
  timespec time{};
  if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &time) != 0)
    ADD_FAILURE() << "no clock of process " << process;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

struct Stopped {
  Outcome run;
  double computed = 0;  ///< s of processor time from the signal to the last file or, without
                        ///< results, to the end
};

/// What the program says that it computed between a signal and the first of the last files.
std::optional<double> told(const std::string& err) {
  std::smatch found;
  static const std::regex sentence(
      "sunder: stopped [0-9.e-]+ s after the signal \\(([0-9.e-]+) s of processor time\\); "
      "writing results to .*, another signal drops them\n");
  if (!std::regex_search(err, found, sentence)) return {};
  return std::stod(found[1]);
}

/// Runs the program and sends it a signal so long after its start.
Stopped stop(const std::vector<std::string>& arguments, std::chrono::microseconds after,
             int signal) {
  Stopped stopped;
  double before = 0;
  RunControl control;
  control.one_processor = true;
  control.meanwhile = [&](pid_t program) {
    wait_for_start(program);
    std::this_thread::sleep_for(after);
    before = processor_seconds(program);
    kill(program, signal);
  };
  stopped.run = run_program(arguments, control);
  stopped.computed = told(stopped.run.err).value_or(stopped.run.processor_seconds - before);
  return stopped;
}

/// None of a run's files, or all of them.
void expect_one_run_or_none(const std::filesystem::path& out, bool interrupted) {
  if (!std::filesystem::exists(out)) return;
  expect_whole_results(out);
  EXPECT_EQ(read_json(out / "summary.json")["interrupted"], interrupted);
}

TEST(Signals, AtRandomMomentsOfARun) {
  const TempFolder folder;
  const TearingBoard board(folder);
  std::mt19937 random(18);
  for (int i = 0; i < 24; ++i) {
    const auto out = folder / ("out" + std::to_string(i));
    const std::chrono::microseconds after(random() % (i % 2 ? 400'000 : 40'000));
    const int signal = random() % 2 ? SIGINT : SIGTERM;
    SCOPED_TRACE("signal " + std::to_string(signal) + " after " + std::to_string(after.count()) +
                 " us");
    const Stopped stopped = stop({"run", board.scene.string(), "--out", out.string(), "--steps",
                                  "100000", "--set", "instrument.0.ramp=[0, 1e3]"},
                                 after, signal);
    EXPECT_EQ(stopped.run.exit_code, 130) << stopped.run.err;
    EXPECT_LE(stopped.computed, kLimit);
    EXPECT_EQ(told(stopped.run.err).has_value(), std::filesystem::exists(out)) << stopped.run.err;
    EXPECT_NE(stopped.run.err.find("sunder: interrupted"), std::string::npos) << stopped.run.err;
    expect_one_run_or_none(out, true);
  }
}

TEST(Signals, WhileABodyIsPrepared) {
  const TempFolder folder;
  const TearingBoard board(folder);
  ASSERT_EQ(run_program({"mesh", "board", "--tets", "16000", "-o", (folder / "board.msh").string()})
                .exit_code,
            0);
  // The dense inverse takes many seconds; an earlier run's results stay.
  const auto out = folder / "out";
  std::filesystem::create_directory(out);
  write_text(out / "summary.json", "{}");
  std::mt19937 random(3);
  for (int i = 0; i < 3; ++i) {
    const std::chrono::microseconds after(300'000 + random() % 700'000);
    const Stopped stopped = stop({"run", board.scene.string(), "--out", out.string(), "--route",
                                  "inverse", "--backend", "cpu", "--quiet"},
                                 after, SIGINT);
    EXPECT_EQ(stopped.run.exit_code, 130) << stopped.run.err;
    EXPECT_LE(stopped.computed, kLimit);
    EXPECT_NE(stopped.run.err.find("nothing was"), std::string::npos) << stopped.run.err;
    EXPECT_EQ(names_in(out), std::vector<std::string>{"summary.json"});
  }
}

// Conjugate gradients without a seventh of the elements: 1.5 s of processor time.
TEST(Signals, WithinALongFrameLeavesItBehind) {
  const TempFolder folder;
  ASSERT_EQ(run_program({"mesh", "board", "--tets", "60000", "-o", (folder / "board.msh").string()})
                .exit_code,
            0);
  const auto scene = folder / "holes.toml";
  std::string holes = "0";
  for (int element = 7; element < 60000; element += 7) holes += ", " + std::to_string(element);
  write_text(scene, board_toml("Holes") + "[[destroy]]\nstep = 0\nelements = [" + holes + "]\n" +
                        "[time]\nsteps = 1\n");
  const auto out = folder / "out";
  RunControl control;
  control.one_processor = true;
  control.meanwhile = [&](pid_t program) {
    EXPECT_TRUE(wait_for(half_written(out, "frames.csv", program)));
    kill(program, SIGINT);
  };
  const Outcome run = run_program(
      {"run", scene.string(), "--out", out.string(), "--route", "cg", "--backend", "cpu"}, control);
  EXPECT_EQ(run.exit_code, 130) << run.err;
  const auto computed = told(run.err);
  ASSERT_TRUE(computed) << run.err;
  EXPECT_LE(*computed, kLimit);
  expect_whole_results(out);
  EXPECT_EQ(read_json(out / "summary.json")["steps_done"], 0);
}

TEST(Signals, WhileGmshMeshesLeavesNothing) {
  const TempFolder folder;
  for (const char* name : {"board.msh", "board.vtk"}) {
    const Stopped stopped = stop(
        {"mesh", "board", "--unstructured", "--tets", "400000", "-o", (folder / name).string()},
        700ms, SIGTERM);
    EXPECT_EQ(stopped.run.exit_code, 130) << stopped.run.err;
    EXPECT_LE(stopped.computed, kLimit);
    EXPECT_NE(stopped.run.err.find("interrupted"), std::string::npos) << stopped.run.err;
    EXPECT_TRUE(names_in(folder.path()).empty());
  }
}

TEST(Signals, ASecondOneDropsTheResults) {
  const TempFolder folder;
  const TearingBoard board(folder);
  const auto out = folder / "out";
  RunControl control;
  control.meanwhile = [&](pid_t program) {
    EXPECT_TRUE(wait_for(half_written(out, "frames.csv", program), 400));
    kill(program, SIGINT);
    kill(program, SIGTERM);
  };
  const Outcome run = run_program({"run", board.scene.string(), "--out", out.string(), "--steps",
                                   "1000000", "--set", "instrument.0.ramp=[0, 1e4]", "--series"},
                                  control);
  EXPECT_EQ(run.exit_code, 130) << run.err;
  EXPECT_NE(run.err.find("sunder: interrupted again: the results so far are dropped\n"),
            std::string::npos)
      << run.err;
  EXPECT_FALSE(std::filesystem::exists(out));
}

/// A pipe in the place of a result file that a run has not begun to write: it gets stuck there
/// until somebody reads.
class StuckFile {
 public:
  StuckFile(const std::filesystem::path& out, const std::string& name, pid_t program) {
    EXPECT_TRUE(wait_for(half_written(out, "frames.csv", program)));
    kill(program, SIGSTOP);
    EXPECT_FALSE(std::filesystem::exists(out / "events.csv")) << "too late";
    const auto path = half_written(out, name, program);
    EXPECT_EQ(mkfifo(path.c_str(), 0600), 0);
    pipe_ = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    EXPECT_GT(fcntl(pipe_, F_SETPIPE_SZ, 4096), 0);
    kill(program, SIGCONT);
  }
  ~StuckFile() { close(pipe_); }
  StuckFile(const StuckFile&) = delete;
  StuckFile& operator=(const StuckFile&) = delete;

  void wait() const {
    int bytes = 0;
    for (int i = 0; i < 60000 && bytes == 0; ++i) {
      std::this_thread::sleep_for(1ms);
      ioctl(pipe_, FIONREAD, &bytes);
    }
    EXPECT_GT(bytes, 0) << "never written";
  }
  void read_all() const {
    fcntl(pipe_, F_SETFL, 0);
    char buffer[4096];
    while (read(pipe_, buffer, sizeof buffer) > 0) continue;
  }

 private:
  int pipe_ = -1;
};

/// A run of 300 steps that is stuck in result.vtu, when all is computed.
Outcome run_stuck(const TearingBoard& board, const std::filesystem::path& out,
                  const std::function<void(pid_t, const StuckFile&)>& then) {
  RunControl control;
  control.meanwhile = [&](pid_t program) {
    const StuckFile file(out, "result.vtu", program);
    file.wait();
    then(program, file);
  };
  return run_program({"run", board.scene.string(), "--out", out.string(), "--steps", "300", "--set",
                      "fracture.model=\"none\""},
                     control);
}

TEST(Signals, WhileTheLastFilesAreWrittenLetsThemBeFinished) {
  const TempFolder folder;
  const TearingBoard board(folder);
  const auto out = folder / "out";
  const Outcome run = run_stuck(board, out, [](pid_t program, const StuckFile& file) {
    kill(program, SIGINT);
    std::this_thread::sleep_for(200ms);  // it waits for it all the time
    file.read_all();
  });
  EXPECT_EQ(run.exit_code, 130) << run.err;
  EXPECT_NE(run.err.find("sunder: interrupted after the last step: the results in " + out.string() +
                         " are complete\n"),
            std::string::npos)
      << run.err;
  const auto summary = read_json(out / "summary.json");
  EXPECT_EQ(summary["interrupted"], false);
  EXPECT_EQ(summary["steps_done"], 300);
  std::filesystem::remove(out / "result.vtu");  // the pipe
  EXPECT_EQ(names_in(out),
            (std::vector<std::string>{"events.csv", "figure.png", "figure.svg", "frames.csv",
                                      "index.html", "summary.json", "tips.csv"}));
}

TEST(Signals, ASecondOneEndsTheWritingInTheMidstOfAFile) {
  const TempFolder folder;
  const TearingBoard board(folder);
  const auto out = folder / "out";
  const Outcome run = run_stuck(board, out, [](pid_t program, const StuckFile& file) {
    kill(program, SIGINT);
    kill(program, SIGTERM);
    for (int i = 0; i < 60000; ++i) {
      siginfo_t end{};
      if (waitid(P_PID, static_cast<id_t>(program), &end, WEXITED | WNOHANG | WNOWAIT) == 0 &&
          end.si_pid == program)
        return;
      std::this_thread::sleep_for(1ms);
    }
    ADD_FAILURE() << "it waits for the file";
    file.read_all();
  });
  EXPECT_EQ(run.exit_code, 130) << run.err;
  EXPECT_NE(run.err.find("sunder: interrupted again: the results so far are dropped\n"),
            std::string::npos)
      << run.err;
  EXPECT_FALSE(std::filesystem::exists(out));
}

/// What the computing of these does: it never comes back.
[[noreturn]] void compute() {
  for (;;) std::this_thread::sleep_for(1h);
}

class InterruptionDeath : public ::testing::Test {
 protected:
  InterruptionDeath() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

TEST_F(InterruptionDeath, WritesWithoutAComputingThatDoesNotEnd) {
  EXPECT_EXIT(
      {
        app::Interruption interruption;
        const app::Expecting expecting(interruption, {"",
                                                      {},
                                                      [] {
                                                        fputs("results", stderr);
                                                        return 130;
                                                      },
                                                      50ms});
        kill(getpid(), SIGTERM);
        compute();
      },
      ::testing::ExitedWithCode(130), "^results$");
}

TEST_F(InterruptionDeath, LeavesAComputingThatEndsItsTurn) {
  EXPECT_EXIT(
      {
        app::Interruption interruption;
        const app::Expecting expecting(interruption, {"",
                                                      {},
                                                      [] {
                                                        fputs("of another thread", stderr);
                                                        return 1;
                                                      },
                                                      60s});
        kill(getpid(), SIGINT);
        while (!interruption.requested()) std::this_thread::sleep_for(1ms);
        interruption.claim();
        fputs("its own", stderr);
        interruption.leave(130);
      },
      ::testing::ExitedWithCode(130), "^its own$");
}

TEST_F(InterruptionDeath, OnlyOneOfThemWrites) {
  EXPECT_EXIT(
      {
        app::Interruption interruption;
        const app::Expecting expecting(interruption, {"",
                                                      {},
                                                      [] {
                                                        std::this_thread::sleep_for(200ms);
                                                        fputs("results", stderr);
                                                        return 130;
                                                      },
                                                      1ms});
        kill(getpid(), SIGINT);
        std::this_thread::sleep_for(100ms);
        interruption.claim();  // too late
        fputs("twice", stderr);
      },
      ::testing::ExitedWithCode(130), "^results$");
}

TEST_F(InterruptionDeath, ASecondSignalEndsASlowWriter) {
  EXPECT_EXIT(
      {
        app::Interruption interruption;
        const app::Expecting expecting(
            interruption,
            {"", [] { return fputs("dropped ", stderr) >= 0; }, []() -> int { compute(); }, 1ms});
        kill(getpid(), SIGINT);
        std::this_thread::sleep_for(100ms);
        kill(getpid(), SIGINT);
        compute();
      },
      ::testing::ExitedWithCode(130), "^dropped sunder: interrupted again");
}

// The last file is written, and the program still tells of it.
TEST_F(InterruptionDeath, ASecondSignalBehindTheLastFileSaysThatItStays) {
  EXPECT_EXIT(
      {
        const TempFolder folder;
        app::ResultFolder results(folder / "out");
        app::Interruption interruption;
        const app::Expecting expecting(interruption,
                                       {"", [&results] { return results.drop(); }, {}, 60s});
        interruption.claim();
        results.clear();
        results.write("summary.json", "{}");
        results.release();
        kill(getpid(), SIGINT);
        while (!interruption.requested()) std::this_thread::sleep_for(1ms);
        kill(getpid(), SIGINT);
        compute();
      },
      ::testing::ExitedWithCode(130),
      "^sunder: interrupted again: all results were written before, and stay\n$");
}

/// One folder for a test and for the process in which it dies.
class SharedFolder {
 public:
  SharedFolder() {
    const char* name = std::getenv(kName);
    if (!name) setenv(kName, own_.emplace().path().c_str(), 1);
    path_ = std::getenv(kName);
  }
  SharedFolder(const SharedFolder&) = delete;
  SharedFolder& operator=(const SharedFolder&) = delete;
  ~SharedFolder() {
    if (own_) unsetenv(kName);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  static constexpr const char* kName = "SUNDER_TEST_SHARED_FOLDER";
  std::optional<TempFolder> own_;
  std::filesystem::path path_;
};

// It comes when the folder is there and nobody has said yet what is to become of it.
TEST_F(InterruptionDeath, ASignalWhileTheFolderIsMadeTakesItBack) {
  const SharedFolder folder;
  EXPECT_EXIT(
      {
        std::optional<app::ResultFolder> results;
        app::Interruption interruption;
        const app::Expecting expecting(
            interruption,
            [&] {
              results.emplace(folder.path() / "out");
              kill(getpid(), SIGINT);
              std::this_thread::sleep_for(100ms);
              return app::Interruption::Duty{"gone", [&] { return results->drop(); }, {}, {}};
            },
            {});
        compute();
      },
      ::testing::ExitedWithCode(130), "^sunder: interrupted: gone\n$");
  EXPECT_TRUE(names_in(folder.path()).empty());
}

TEST_F(InterruptionDeath, ASignalAtTheEndFindsTheFolderTakenBack) {
  const SharedFolder folder;
  EXPECT_EXIT(
      {
        std::optional<app::ResultFolder> results;
        app::Interruption interruption;
        try {
          const auto expecting =
              app::in_folder(interruption, results, folder.path() / "out",
                             "not written: ", [] { fputs("never called", stderr); });
          throw UsageError("as preparing does");
        } catch (const UsageError&) {
          kill(getpid(), SIGINT);
          compute();
        }
      },
      ::testing::ExitedWithCode(130), "^sunder: interrupted: nothing was written\n$");
  EXPECT_TRUE(names_in(folder.path()).empty());
}

TEST_F(InterruptionDeath, AfterAllIsDoneASignalTakesNothingBack) {
  EXPECT_EXIT(
      {
        app::Interruption interruption;
        const app::Expecting expecting(interruption,
                                       {"", [] { return fputs("dropped ", stderr) >= 0; }, {}, {}});
        interruption.over(5);
        kill(getpid(), SIGINT);
        compute();  // destructors that wait for threads
      },
      ::testing::ExitedWithCode(5), "^$");
}

}  // namespace
}  // namespace sunder::test
