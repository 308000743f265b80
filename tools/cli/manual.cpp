// dyn manual: the man page and the completions of shells, from the options that the subcommands have. Hidden: the build calls it
// and installs what it prints.
#include <CLI/CLI.hpp>

#include "cli.hpp"

namespace cli {
namespace {

using Commands = std::vector<const CLI::App*>;
using OptionList = std::vector<const CLI::Option*>;

Commands commands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* c) { return !c->get_group().empty(); });
}
OptionList options(const CLI::App& command) {
  return command.get_options([](const CLI::Option* o) { return !o->get_group().empty(); });
}
std::vector<std::string> names(const CLI::Option& o) {
  std::vector<std::string> out;
  for (const std::string& s : o.get_snames()) out.push_back("-" + s);
  for (const std::string& l : o.get_lnames()) out.push_back("--" + l);
  return out;
}
// "FILE", "none|hull"; "" of a flag.
std::string argument(const CLI::Option& o) {
  const std::string type = o.get_type_name();
  return o.get_type_size() == 0 ? "" : type.substr(0, type.find(':'));
}
// What may follow, separated by spaces: of complete(), or of a type such as {none,hull}.
std::string choices_of(const CLI::Option& o) {
  if (const Values* values = values_of(&o)) return join(values->names, " ");
  const std::string type = o.get_type_name();
  const std::size_t from = type.find('{'), to = type.find('}');
  std::string out = from < to && to != std::string::npos ? type.substr(from + 1, to - from - 1) : "";
  for (char& c : out)
    if (c == ',') c = ' ';
  return out;
}
bool takes_list(const CLI::Option& o) { return values_of(&o) && values_of(&o)->list; }
bool takes_file(const CLI::Option& o) {
  const std::string a = argument(o);
  for (const char* name : {"FILE", "DIR", "OUT", "IN", "json"})
    if (a.find(name) != std::string::npos) return true;
  return false;
}
std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size()) text.replace(at, what.size(), by);
  return text;
}
// For roff: no character begins a request or an escape.
std::string roff(const std::string& text) {
  std::string out = replaced(replaced(text, "\\", "\\e"), "-", "\\-");
  return !out.empty() && (out[0] == '.' || out[0] == '\'') ? "\\&" + out : out;
}
// Inside single quotes of a shell.
std::string in_quotes(const std::string& text) { return replaced(text, "'", "'\\''"); }

std::string man(const CLI::App& app) {
  std::string out = ".TH DYN 1 \"\" \"dyn " + std::string(dyn_version()) +
                    "\" \"User Commands\"\n.SH NAME\ndyn \\- rigid\\-body dynamics\n.SH SYNOPSIS\n";
  for (const CLI::App* c : commands(app)) {
    out += ".B dyn " + c->get_name() + "\n[OPTIONS]";
    for (const CLI::Option* o : options(*c))
      if (o->get_positional()) out += o->get_required() ? " " + o->get_single_name() : " [" + o->get_single_name() + "]";
    out += "\n.br\n";
  }
  out += ".SH DESCRIPTION\n" + roff(app.get_description()) +
         "\nA robot is a URDF, MJCF or .dynb file. \\-\\-fixed or \\-\\-floating holds the root link of a URDF.\n";
  out += ".SH COMMANDS\n";
  for (const CLI::App* c : commands(app)) {
    out += ".SS dyn " + c->get_name() + "\n" + roff(c->get_description()) + ".\n";
    for (const CLI::Option* o : options(*c)) {
      const std::string value = argument(*o);
      const std::string name = o->get_positional() ? o->get_single_name() : join(names(*o)) + (value.empty() ? "" : " " + value);
      out += ".TP\n.B " + roff(name) + "\n" + roff(o->get_description()) +
             (o->get_default_str().empty() ? "" : " (default " + roff(o->get_default_str()) + ")") + "\n";
    }
    if (!c->get_footer().empty()) out += ".PP\n" + roff(c->get_footer()) + "\n";
  }
  out +=
      ".SH EXIT STATUS\n.TP\n0\nsuccess\n.TP\n1\nan operation on the robot or on files failed\n.TP\n2\nthe command line is "
      "wrong\n";
  return out +
         ".SH FILES\nMessages are on standard error; the answer, with \\-\\-json for programs, is all there is on standard "
         "output.\n";
}

std::string bash(const CLI::App& app) {
  std::string all;
  std::string cases;
  for (const CLI::App* c : commands(app)) {
    all += (all.empty() ? "" : " ") + c->get_name();
    std::string words, values;
    for (const CLI::Option* o : options(*c)) {
      if (o->get_positional()) continue;
      words += (words.empty() ? "" : " ") + join(names(*o), " ");
      if (!choices_of(*o).empty())
        values += "        " + join(names(*o), "|") + ") " + (takes_list(*o) ? "_dyn_list" : "_dyn_one") + " '" + choices_of(*o) +
                  "'; return ;;\n";
    }
    cases += "    " + c->get_name() + ")\n      case $before in\n" + values + "      esac\n      words='" + words + "' ;;\n";
  }
  return "# bash completion of dyn\n_dyn_one() { COMPREPLY=($(compgen -W \"$1\" -- \"$now\")); }\n"
         "_dyn_list() {  # the last of some with commas between\n  compopt -o nospace 2>/dev/null\n"
         "  COMPREPLY=($(compgen -P \"${now%\"${now##*,}\"}\" -W \"$1\" -- \"${now##*,}\"))\n}\n_dyn() {\n  local now=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} words=\n  "
         "COMPREPLY=()\n"
         "  if [ \"$COMP_CWORD\" = 1 ]; then COMPREPLY=($(compgen -W '" +
         all +
         " --help --version' -- \"$now\")); return; fi\n"
         "  case ${COMP_WORDS[1]} in\n" +
         cases +
         "  esac\n  case $now in\n    -*) COMPREPLY=($(compgen -W \"$words\" -- \"$now\")) ;;\n"
         "    *) COMPREPLY=($(compgen -f -- \"$now\")) ;;\n  esac\n}\ncomplete -o filenames -F _dyn dyn\n";
}

std::string zsh(const CLI::App& app) {
  std::string out = "#compdef dyn\nlocal -a commands\ncommands=(\n", cases;
  for (const CLI::App* c : commands(app)) {
    out += "  '" + c->get_name() + ":" + in_quotes(replaced(c->get_description(), ":", "\\:")) + "'\n";
    cases += "  " + c->get_name() + ") _arguments";
    for (const CLI::Option* o : options(*c)) {
      if (o->get_positional()) continue;
      const std::string text = in_quotes(replaced(replaced(replaced(o->get_description(), "[", "("), "]", ")"), ":", "\\:"));
      for (const std::string& name : names(*o)) {
        cases += " \\\n      '" + name + "[" + text + "]";
        if (!argument(*o).empty())
          cases += ":value:" + (takes_list(*o)           ? "_sequence compadd - " + choices_of(*o)
                                : !choices_of(*o).empty() ? "(" + choices_of(*o) + ")"
                                                          : std::string(takes_file(*o) ? "_files" : " "));
        cases += "'";
      }
    }
    cases += " \\\n      '*:file:_files' ;;\n";
  }
  return out + ")\nif (( CURRENT == 2 )); then _describe command commands; return; fi\ncase $words[2] in\n" + cases + "esac\n";
}

std::string fish(const CLI::App& app) {
  std::string out = "# fish completion of dyn\n";
  for (const CLI::App* c : commands(app)) {
    out += "complete -c dyn -n __fish_use_subcommand -a " + c->get_name() + " -d '" + in_quotes(c->get_description()) + "'\n";
    for (const CLI::Option* o : options(*c)) {
      if (o->get_positional()) continue;
      out += "complete -c dyn -n '__fish_seen_subcommand_from " + c->get_name() + "'";
      for (const std::string& s : o->get_snames()) out += " -s " + s;
      for (const std::string& l : o->get_lnames()) out += " -l " + l;
      if (!argument(*o).empty()) out += takes_file(*o) ? " -r" : " -x";
      if (takes_list(*o)) out += " -a '(__fish_complete_list , \"printf \\\"%s\\n\\\" " + choices_of(*o) + "\")'";
      else if (!choices_of(*o).empty()) out += " -a '" + choices_of(*o) + "'";
      out += " -d '" + in_quotes(o->get_description()) + "'\n";
    }
  }
  return out;
}

}  // namespace

void add_manual(CLI::App& app) {
  CLI::App* command = app.add_subcommand("manual", "The man page, or a shell's completions")->group("");
  auto form = std::make_shared<std::string>();
  command->add_option("FORM", *form, "man, bash, zsh or fish")->required()->check(CLI::IsMember({"man", "bash", "zsh", "fish"}));
  command->callback([&app, form] {
    print(*form == "man" ? man(app) : *form == "bash" ? bash(app) : *form == "zsh" ? zsh(app) : fish(app));
  });
}

}  // namespace cli
