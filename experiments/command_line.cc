#include "experiments/command_line.h"

#include <gflags/gflags.h>

#include <algorithm>
#include <cstdio>

#include "common/support/input_error.h"
#include "common/support/nearest_name.h"
#include "experiments/build_info.h"
#include "experiments/exit_status.h"

namespace duet {
namespace {

constexpr std::size_t kHelpWidth = 96;
constexpr std::size_t kFlagColumn = 26;

std::string Joined(const std::vector<std::string>& words, const std::string& separator) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

/// gflags' names are identifiers; on the command line a dash does as well.
std::string GflagsName(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

std::string VariableOf(const FlagUse& flag) {
  return flag.variable.empty() ? GflagsName(flag.name) : flag.variable;
}

gflags::CommandLineFlagInfo InfoOf(const FlagUse& flag) {
  return gflags::GetCommandLineFlagInfoOrDie(VariableOf(flag).c_str());
}

/// Breaks at spaces; every line after the first is indented.
std::string Wrapped(const std::string& text, std::size_t indent) {
  std::string out;
  std::size_t column = indent;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::size_t length = end - begin;
    if (column > indent && column + 1 + length > kHelpWidth) {
      out += "\n" + std::string(indent, ' ');
      column = indent;
    } else if (column > indent) {
      out += ' ';
      ++column;
    }
    out.append(text, begin, length);
    column += length;
    begin = end + 1;
  }
  return out;
}

std::string KindOf(const std::string& type) {
  if (type == "double") return "a number";
  if (type == "bool") return "true or false";
  return type == "string" ? "text" : "a whole number";
}

}  // namespace

class CommandLineParser {
 public:
  explicit CommandLineParser(const Command& command) : command_(command) {}

  CommandLine Parse(int argc, const char* const* argv) {
    line_.text_ = "duet";
    for (int i = 1; i < argc; ++i) line_.text_ += " " + ShellQuoted(argv[i]);
    bool flags_ended = false;
    for (int i = 2; i < argc; ++i) {
      const std::string word = argv[i];
      if (!flags_ended && word == "--") {
        flags_ended = true;
      } else if (flags_ended || word.size() < 2 || word[0] != '-') {
        line_.operands_.push_back(word);
      } else if (TakeFlag(word, i + 1 < argc ? argv[i + 1] : nullptr)) {
        ++i;
      }
    }
    if (command_.operands.empty() && !line_.operands_.empty()) {
      throw InputError("'" + line_.operands_.front() + "' is no flag, and duet " + command_.name +
                       " takes nothing else; see duet help " + command_.name);
    }
    return line_;
  }

  void RequireAll(const CommandLine& line) const {
    for (const FlagUse& flag : command_.flags) {
      if (flag.required && !line.Given(flag.name)) {
        throw InputError("duet " + command_.name + " needs --" + flag.name + " " + flag.value +
                         "; see duet help " + command_.name);
      }
    }
  }

 private:
  /// True where the next word was taken as the value.
  bool TakeFlag(const std::string& word, const char* next) {
    const std::size_t name_begin = word.compare(0, 2, "--") == 0 ? 2 : 1;
    const std::size_t equals = word.find('=', name_begin);
    const std::string name = word.substr(
        name_begin, equals == std::string::npos ? std::string::npos : equals - name_begin);
    bool negated = false;
    const FlagUse& flag = Find(name, &negated);
    const bool is_switch = InfoOf(flag).type == "bool";
    if (negated && equals != std::string::npos) {
      throw InputError("--" + name + " takes no value");
    }
    if (equals != std::string::npos) {
      Set(flag, word.substr(equals + 1));
      return false;
    }
    if (is_switch) {
      Set(flag, negated ? "false" : "true");
      return false;
    }
    if (next == nullptr) throw InputError("--" + name + " needs a value (" + flag.value + ")");
    Set(flag, next);
    return true;
  }

  const FlagUse& Find(const std::string& name, bool* negated) const {
    std::vector<std::string> names;
    for (const FlagUse& flag : command_.flags) {
      if (GflagsName(flag.name) == GflagsName(name)) return flag;
      if (GflagsName(name) == "no" + GflagsName(flag.name) && InfoOf(flag).type == "bool") {
        *negated = true;
        return flag;
      }
      names.push_back(flag.name);
    }
    const std::string nearest = NearestName(name, names);
    throw InputError("duet " + command_.name + " has no flag --" + name +
                     (nearest.empty() ? "; see duet help " + command_.name
                                      : "; did you mean --" + nearest + "?"));
  }

  void Set(const FlagUse& flag, const std::string& value) {
    if (!flag.choices.empty() &&
        std::find(flag.choices.begin(), flag.choices.end(), value) == flag.choices.end()) {
      throw InputError("--" + flag.name + ": '" + value + "' is none of " +
                       Joined(flag.choices, ", ") + DidYouMean(value, flag.choices));
    }
    if (!flag.repeatable && line_.Given(flag.name)) {
      throw InputError("--" + flag.name + " is given more than once");
    }
    if (gflags::SetCommandLineOption(VariableOf(flag).c_str(), value.c_str()).empty()) {
      throw InputError("--" + flag.name + ": '" + value + "' is not " + KindOf(InfoOf(flag).type));
    }
    line_.values_[flag.name].push_back(value);
  }

  const Command& command_;
  CommandLine line_;
};

const std::vector<std::string>& CommandLine::All(const std::string& flag) const {
  static const std::vector<std::string> none;
  const auto found = values_.find(flag);
  return found == values_.end() ? none : found->second;
}

std::string ShellQuoted(const std::string& word) {
  const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string("_-./=:,+@%").find(c) != std::string::npos;
  });
  if (plain) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string CommandHelp(const Command& command) {
  std::string text = "duet " + command.name;
  for (const FlagUse& flag : command.flags) {
    if (flag.required) text += " --" + flag.name + " " + flag.value;
  }
  if (!command.operands.empty()) text += " " + command.operands;
  text += " [flags]\n\n" + Wrapped(command.description, 0) + "\n\n" + command.table +
          (command.table.empty() ? "Flags\n" : "\nFlags\n");
  for (const FlagUse& flag : command.flags) {
    const gflags::CommandLineFlagInfo info = InfoOf(flag);
    std::string head = "  --" + flag.name + (flag.value.empty() ? "" : " " + flag.value);
    if (head.size() + 1 < kFlagColumn) {
      head.resize(kFlagColumn, ' ');
    } else {
      head += "\n" + std::string(kFlagColumn, ' ');
    }
    std::string meaning = flag.meaning.empty() ? info.description : flag.meaning;
    if (flag.repeatable) meaning += " May be repeated.";
    if (flag.required) {
      meaning += " Required.";
    } else if (!flag.without.empty()) {
      meaning += " Default: " + flag.without + ".";
    } else if (!info.default_value.empty()) {
      meaning += " Default: " + info.default_value + ".";
    }
    text += head + Wrapped(meaning, kFlagColumn) + "\n";
  }
  return text + "\nExample\n  " + command.example + "\n";
}

std::string ProgramHelp(const std::vector<Command>& commands) {
  std::string text =
      "Duet: the same images and the same IMU, through a filter and through an optimizer.\n\n"
      "  duet COMMAND [flags]\n\nCommands\n";
  std::size_t width = 0;
  for (const Command& command : commands) width = std::max(width, command.name.size());
  width += 2;
  const auto row = [width](std::string name, const std::string& summary) {
    name.resize(width, ' ');
    return "  " + name + Wrapped(summary, width + 2) + "\n";
  };
  for (const Command& command : commands) text += row(command.name, command.summary);
  text += row("help", "This text; duet help COMMAND for the flags of one command.");
  text += row("version", "Version, commit, build and libraries.");
  text +=
      "\nExit status\n"
      "  0 done (a comparison in which one estimator failed included), 1 a bound of --require is\n"
      "  not met, 2 usage or bad input, 3 the run's estimator failed, 4 writing failed,\n"
      "  130 interrupted.\n";
  return text;
}

int Dispatch(const std::vector<Command>& commands, int argc, const char* const* argv) {
  const std::string name = argc > 1 ? argv[1] : "help";
  const auto is_help = [](const std::string& word) {
    return word == "help" || word == "--help" || word == "-help" || word == "-h";
  };
  if (name == "version" || name == "--version") {
    std::fputs(BuildDescription().c_str(), stdout);
    return kDone;
  }
  const bool asks_help = is_help(name);
  const std::string subject = asks_help ? (argc > 2 ? argv[2] : "") : name;
  if (subject.empty()) {
    std::fputs(ProgramHelp(commands).c_str(), stdout);
    return kDone;
  }
  const auto command = std::find_if(commands.begin(), commands.end(),
                                    [&](const Command& c) { return c.name == subject; });
  if (command == commands.end()) {
    std::vector<std::string> names = {"help", "version"};
    for (const Command& c : commands) names.push_back(c.name);
    const std::string nearest = NearestName(subject, names);
    throw InputError("there is no command '" + subject + "'" +
                     (nearest.empty() ? "; see duet help" : "; did you mean '" + nearest + "'?"));
  }
  const bool flag_help = std::any_of(argv + std::min(2, argc), argv + argc, [&](const char* word) {
    return is_help(word) && word[0] == '-';
  });
  if (asks_help || flag_help) {
    std::fputs(CommandHelp(*command).c_str(), stdout);
    return kDone;
  }
  CommandLineParser parser(*command);
  const CommandLine line = parser.Parse(argc, argv);
  parser.RequireAll(line);
  return command->run(line);
}

}  // namespace duet
