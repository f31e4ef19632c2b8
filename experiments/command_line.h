#pragma once

#include <map>
#include <string>
#include <vector>

namespace duet {

/// One flag that a command takes. Type, default and meaning are those of the gflags flag of the
/// same name, which the program's files define.
struct FlagUse {
  std::string name;
  std::string value = {};  ///< what stands for the value in the help: "DIR", "S"; empty: a switch
  bool required = false;
  bool repeatable = false;                ///< every value is kept: CommandLine::All
  std::vector<std::string> choices = {};  ///< the values allowed; empty: any
  std::string without = {};  ///< for the help, where it is not the flag's default: "all cores"
  std::string meaning = {};  ///< for the help, where it is not the flag's description
  /// Its gflags variable, where commands mean different things by one name: "figure_runs".
  std::string variable = {};
};

/// A command as it was called: which flags were given. Values are in gflags' variables; those of
/// repeatable flags are here.
class CommandLine {
 public:
  [[nodiscard]] bool Given(const std::string& flag) const { return values_.contains(flag); }
  /// Every value of a flag, in the order given.
  [[nodiscard]] const std::vector<std::string>& All(const std::string& flag) const;
  /// What is no flag, in the order given.
  [[nodiscard]] const std::vector<std::string>& operands() const { return operands_; }
  /// The whole command line, quoted for a shell where needed, for the manifest.
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  friend class CommandLineParser;
  std::map<std::string, std::vector<std::string>> values_;
  std::vector<std::string> operands_;
  std::string text_;
};

/// A subcommand of the program.
struct Command {
  std::string name;
  std::string summary;      ///< one line of `duet help`
  std::string description;  ///< paragraphs of `duet help NAME`
  std::string example;
  std::vector<FlagUse> flags = {};
  std::string operands =
      {};                  ///< what the words that are no flags are: "FILE..."; empty: none taken
  std::string table = {};  ///< of `duet help NAME` after the description, printed as it is
  int (*run)(const CommandLine& line) = nullptr;
};

/// Finds the command, sets its flags and runs it; `help` and `version` are built in. Returns the
/// exit status. Throws InputError for an unknown command or flag (naming the nearest), for a value
/// of the wrong kind, and for a required flag that is missing.
int Dispatch(const std::vector<Command>& commands, int argc, const char* const* argv);

/// The text of `duet help` and of `duet help COMMAND`.
[[nodiscard]] std::string ProgramHelp(const std::vector<Command>& commands);
[[nodiscard]] std::string CommandHelp(const Command& command);

/// A word as a shell would need it.
[[nodiscard]] std::string ShellQuoted(const std::string& word);

}  // namespace duet
