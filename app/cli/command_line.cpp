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

std::string path_of(const CLI::App& command) {
  const CLI::App* parent = command.get_parent();
  return parent ? path_of(*parent) + " " + command.get_name() : command.get_name();
}

/// Where the allowed arguments are listed.
std::string see(const CLI::App& command) {
  const std::string path = path_of(command);
  return "; `" + path + " --help` lists what is allowed";
}

std::string help_text(const CLI::App& command) {
  const CLI::App* parent = command.get_parent();
  return command.help(parent ? path_of(*parent) : "");
}

std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

std::string unexpected_argument(const CLI::App& command, const std::string& argument) {
  const bool option = argument.starts_with("-");
  const std::vector<std::string> commands = command_names(command);
  if (!commands.empty() && !option)
    return path_of(command) + " has no command " + in_quotes(argument) + "; allowed is " +
           quoted_list(commands);
  const std::string close = option ? nearest(argument, option_names(command)) : "";
  return path_of(command) + (option ? " has no option " : " takes no further argument ") +
         in_quotes(argument) + (close.empty() ? "" : ", perhaps " + close + " was meant") +
         see(command);
}

std::string usage_message(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& command = meant(app);
  const std::vector<std::string> extra = app.remaining(true);
  if (!extra.empty()) return unexpected_argument(command, extra.front());
  const std::vector<std::string> commands = command_names(command);
  if (!commands.empty())
    return path_of(command) + " needs a command; allowed is " + quoted_list(commands);
  const std::string what = error.what();
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error))
    return path_of(command) + ": " + what.substr(0, what.find(':')) + " takes exactly one value" +
           see(command);
  return path_of(command) + ": " + what + see(command);
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
  std::cout << help_text(*command);
  return 0;
}

int dispatch(int argc, const char* const* argv, Interruption& interruption) {
  CLI::App app("Soft tissue that tears: deformation, rupture and crack growth under instruments.",
               "sunder");
  app.set_help_flag("-h,--help", "Show this help");
  app.set_version_flag("--version", "sunder " SUNDER_VERSION);
  app.require_subcommand(1);
  app.allow_windows_style_options(false);  // there "/name" is a path as well
  Options options;
  add_commands(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    std::cout << help_text(meant(app));
    return 0;
  } catch (const CLI::CallForVersion&) {
    std::cout << app.version() << "\n";
    return 0;
  } catch (const CLI::ParseError& error) {
    return report(usage_message(app, error), 2);
  }
  if (app.got_subcommand("help")) return help(app, options.help_path);
  return carry_out(app, options, interruption);
}

}  // namespace

int command_line(int argc, const char* const* argv, Interruption& interruption) {
  try {
    const int exit_code = dispatch(argc, argv, interruption);
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
