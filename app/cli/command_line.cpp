// SPDX-License-Identifier: Apache-2.0
#include "app/cli/command_line.hpp"

#include <CLI/CLI.hpp>
#include <iostream>
#include <new>

#include "app/cli/options.hpp"
#include "app/cli/values.hpp"
#include "app/commands/commands.hpp"
#include "app/input/nearest.hpp"
#include "sunder/error.hpp"

namespace sunder::app {
namespace {

constexpr const char* kSeeHelp = "; `sunder help` lists what is allowed";

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands(nullptr)) names.push_back(command->get_name());
  return names;
}

/// The command that a wrong command line was meant for.
const CLI::App& meant(const CLI::App& app) {
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  return *command;
}

std::string unexpected_argument(const CLI::App& app) {
  const CLI::App& command = meant(app);
  const std::vector<std::string> extra = app.remaining(true);
  const std::string first = extra.empty() ? "an argument" : "\"" + extra.front() + "\"";
  const bool option = !extra.empty() && extra.front().starts_with("-");
  if (&command == &app && !option)
    return "there is no command " + first + "; allowed are " +
           quoted_list(command_names(app), "and");
  std::vector<std::string> known;
  for (const CLI::Option* o : command.get_options())
    for (const std::string& name : o->get_lnames()) known.push_back("--" + name);
  const std::string close = option ? nearest(extra.front(), known) : "";
  const std::string path = &command == &app ? "sunder" : "sunder " + command.get_name();
  return path + (option ? " has no option " : " does not take ") + first +
         (close.empty() ? "" : ", perhaps " + close + " was meant") + kSeeHelp;
}

std::string usage_message(const CLI::App& app, const CLI::ParseError& error) {
  if (dynamic_cast<const CLI::ExtrasError*>(&error)) return unexpected_argument(app);
  std::string what = error.what();
  for (char& c : what)
    if (c == '\n') c = ' ';
  if (dynamic_cast<const CLI::RequiredError*>(&error) && meant(app).get_name() == app.get_name())
    return "no command was given; allowed are " + quoted_list(command_names(app), "and");
  return what + kSeeHelp;
}

int report(const std::string& message, int exit_code) {
  std::cout.flush();
  std::cerr << "sunder: error: " << message << std::endl;
  return exit_code;
}

int help(CLI::App& app, const std::vector<std::string>& path) {
  const CLI::App* command = &app;
  for (const std::string& name : path) {
    const std::vector<std::string> known = command_names(*command);
    check_word("the command after help", name, known);
    command = command->get_subcommand(name);
  }
  std::cout << command->help();
  return 0;
}

int dispatch(int argc, const char* const* argv) {
  CLI::App app("Soft tissue that tears: deformation, rupture and crack growth under instruments.",
               "sunder");
  app.set_help_flag("-h,--help", "Show this help");
  app.set_version_flag("--version", "sunder " SUNDER_VERSION);
  app.require_subcommand(1);
  Options options;
  add_commands(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    std::cout << meant(app).help();
    return 0;
  } catch (const CLI::CallForVersion&) {
    std::cout << app.version() << "\n";
    return 0;
  } catch (const CLI::ParseError& error) {
    return report(usage_message(app, error), 2);
  }
  if (app.got_subcommand("help")) return help(app, options.help_path);
  return carry_out(app, options);
}

}  // namespace

int command_line(int argc, const char* const* argv) {
  try {
    const int exit_code = dispatch(argc, argv);
    std::cout.flush();
    if (!std::cout) return report("cannot write to standard output", 1);
    return exit_code;
  } catch (const Error& error) {
    return report(error.what(), error.exit_code());
  } catch (const std::bad_alloc&) {
    return report("out of memory; `sunder plan` tells what a scene needs", 1);
  } catch (const std::exception& error) {
    return report(std::string("internal error: ") + error.what(), 1);
  }
}

}  // namespace sunder::app
