// SPDX-License-Identifier: Apache-2.0
#include "app/output/program.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <sstream>
#include <stdexcept>

namespace sunder::test {
namespace {

struct Pipe {
  std::array<int, 2> ends{};
  Pipe() {
    if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  }
};

[[noreturn]] void become_program(const std::vector<std::string>& arguments,
                                 const RunControl& control, int out, int err) {
  if (!control.standard_output.empty())
    out = open(control.standard_output.c_str(), O_WRONLY | O_CLOEXEC);
  dup2(out, STDOUT_FILENO);
  dup2(err, STDERR_FILENO);
  if (control.file_size_limit > 0) {
    const rlimit limit{control.file_size_limit, control.file_size_limit};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  if (control.one_processor) {
    cpu_set_t here;
    CPU_ZERO(&here);
    CPU_SET(static_cast<std::size_t>(sched_getcpu()), &here);
    sched_setaffinity(0, sizeof here, &here);
  }
  std::vector<std::string> copies = {SUNDER_PROGRAM};
  copies.insert(copies.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& argument : copies) argv.push_back(argument.data());
  argv.push_back(nullptr);
  execv(SUNDER_PROGRAM, argv.data());
  _exit(127);
}

/// Both pipes at once: a full one would stop the program.
void drain(int out, int err, Outcome& outcome) {
  std::array<pollfd, 2> polls{{{out, POLLIN, 0}, {err, POLLIN, 0}}};
  std::array<char, 4096> buffer;
  for (int open = 2; open > 0;) {
    poll(polls.data(), polls.size(), -1);
    for (pollfd& p : polls) {
      if (p.revents == 0) continue;
      const ssize_t got = read(p.fd, buffer.data(), buffer.size());
      if (got > 0) {
        (p.fd == out ? outcome.out : outcome.err).append(buffer.data(), static_cast<size_t>(got));
      } else {
        p.fd = -1;
        --open;
      }
    }
  }
}

}  // namespace

TempFolder::TempFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "sunder-test-XXXXXX").string();
  if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
  path_ = name;
}

TempFolder::~TempFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

Outcome run_program(const std::vector<std::string>& arguments, const RunControl& control) {
  const Pipe out, err;
  const pid_t child = fork();
  if (child == 0) become_program(arguments, control, out.ends[1], err.ends[1]);
  close(out.ends[1]);
  close(err.ends[1]);
  if (control.meanwhile) control.meanwhile(child);
  Outcome outcome;
  drain(out.ends[0], err.ends[0], outcome);
  close(out.ends[0]);
  close(err.ends[0]);
  int status = 0;
  rusage used{};
  wait4(child, &status, 0, &used);
  for (const timeval& time : {used.ru_utime, used.ru_stime})
    outcome.processor_seconds +=
        static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  return outcome;
}

std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + path.string());
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

nlohmann::ordered_json read_json(const std::filesystem::path& path) {
  return nlohmann::ordered_json::parse(read_file(path));
}

namespace {

/// A comma in quotes is part of its cell; two quotes there are one.
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') {
      const bool twice = quoted && i + 1 < line.size() && line[i + 1] == '"';
      if (twice) cells.back() += line[i++];
      if (!twice) quoted = !quoted;
    } else if (line[i] == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += line[i];
    }
  }
  return cells;
}

}  // namespace

std::vector<std::vector<std::string>> read_csv(const std::filesystem::path& path) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(read_file(path));
  for (std::string line; std::getline(lines, line);) rows.push_back(cells_of(line));
  return rows;
}

std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string board_toml(const std::string& title) {
  return "title = \"" + title + "\"" + R"toml(
mesh = "board.msh"
[material]
upper = { young = 5.0, poisson = 0.4, yield = 2.0 }
lower = { young = 8.0, poisson = 0.4, yield = 4.0 }
top-frame = { young = 500.0, poisson = 0.4 }
bottom-frame = { young = 500.0, poisson = 0.4 }
[[fixed]]
box = [[-1.0, 49.999, -1.0], [51.0, 50.001, 3.0]]
[[instrument]]
name = "right forceps"
kind = "expansion"
box = [[49.999, -0.001, -1.0], [50.001, 0.001, 3.0]]
force = [0.0, -150.0, 0.0]
ramp = [0.0, 1.0]
)toml";
}

TearingBoard::TearingBoard(const TempFolder& folder) : scene(folder / "torn.toml") {
  const Outcome mesh = run_program({"mesh", "board", "--nx", "10", "--ny", "10", "--nz", "1", "-o",
                                    (folder / "board.msh").string()});
  if (mesh.exit_code != 0) throw std::runtime_error("no board: " + mesh.err);
  write_text(scene, board_toml("Board <pulled> & torn") + R"toml([[destroy]]
step = 1
elements = [0, 1]
[fracture]
model = "B"
max_events = 8
[time]
steps = 5
)toml");
}

namespace {

struct TornBoard {
  TempFolder folder;
  TearingBoard board{folder};
  std::filesystem::path results = folder / "results";
  Outcome outcome = run_program({"run", board.scene.string(), "--out", results.string(), "--series",
                                 "--snapshots", "3,10,9000"});
};

const TornBoard& torn() {
  static const TornBoard board;
  return board;
}

}  // namespace

const std::filesystem::path& torn_board() { return torn().results; }
const Outcome& torn_board_outcome() { return torn().outcome; }

}  // namespace sunder::test
