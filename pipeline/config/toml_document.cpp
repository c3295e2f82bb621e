// TOML text and command-line overrides as one JSON tree.
#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <span>
#include <sstream>
#include <vector>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/config/constraint.h"
#include "pipeline/config/external_config.h"
#include "pipeline/config/field_reader.h"
#include "pipeline/config/study_keys.h"

namespace npdr::pipeline {
namespace {

using Path = std::vector<std::string>;

// toml++ destroys nested tables recursively; a key of very many parts would overflow the stack.
constexpr std::ptrdiff_t kMaxDotsOfFile = 4'999;  // of up to 9998 levels, in 4 MB of stack
constexpr std::ptrdiff_t kMaxDotsOfOverride = 1'000;

// But for those of numbers, between digits and the only one of its word. Every other dot of a key
// counts at least: "1.1 . 1.1".
std::ptrdiff_t count_dots(std::string_view text) {
  const auto is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  std::ptrdiff_t all = 0;
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find_first_of(" \t\r\n,=[]{}"));
    const std::ptrdiff_t dots = std::ranges::count(word, '.');
    const std::size_t dot = word.find('.');
    const bool is_number = dots == 1 && dot > 0 && dot + 1 < word.size() &&
                           is_digit(word[dot - 1]) && is_digit(word[dot + 1]);
    if (!is_number) all += dots;
    text.remove_prefix(std::min(word.size() + 1, text.size()));
  }
  return all;
}

void require_few_dots(std::string_view text, std::ptrdiff_t limit) {
  const std::ptrdiff_t dots = count_dots(text);
  if (dots <= limit) return;
  throw InputError(fmt::format(
      "holds {} dots beside those of numbers, more than a study needs ({})", dots, limit));
}

// One key=value of the command line, not parsed yet.
struct Assignment {
  std::string origin;  // "--set key=value"
  std::string key;
  std::string value;
  std::size_t number;  // among those of the command line
};

std::size_t find_equals_sign(const std::string& text) {
  char quote = '\0';
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (quote != '\0') {
      if (text[i] == quote) quote = '\0';
    } else if (text[i] == '"' || text[i] == '\'') {
      quote = text[i];
    } else if (text[i] == '=') {
      return i;
    }
  }
  return std::string::npos;
}

Assignment parse_assignment(const std::string& text, std::size_t number) {
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  const std::size_t equals = find_equals_sign(text);
  if (equals == std::string::npos || std::any_of(text.begin(), text.end(), is_control)) {
    throw InputError("must be one line of the form key=value");
  }
  require_few_dots(text, kMaxDotsOfOverride);
  return {kOverride + text, text.substr(0, equals), text.substr(equals + 1), number};
}

Path parse_key(const std::string& key) {
  toml::table parsed;
  try {
    parsed = toml::parse(key + " = 0");
  } catch (const toml::parse_error&) {
    throw InputError(quoted(key) + " isn't a dotted key; quote names with other characters than " +
                     "letters, digits, '_' and '-': method.\"NPDR (MAF)\".num_rounds=2");
  }
  Path path;
  const toml::node* node = &parsed;
  while (node->is_table() && node->as_table()->size() == 1) {
    const auto first = node->as_table()->begin();
    path.emplace_back(first->first.str());
    node = &first->second;
  }
  // A '#' makes the rest a comment, and brackets a table of what is before it.
  if (!node->is_integer()) throw InputError(quoted(key) + " isn't a dotted key");
  return path;
}

// A table that holds the value under the key "value": toml++ has no free-standing values. Its line
// is that of the assignment on the command line. A text may stand without quotes.
toml::table parse_value(const Assignment& assignment) {
  const auto parse = [&](const std::string& value) {
    return toml::parse(std::string(assignment.number, '\n') + "value = " + value,
                       std::string_view(assignment.origin));
  };
  try {
    return parse(assignment.value);
  } catch (const toml::parse_error&) {
    const std::size_t begin = assignment.value.find_first_not_of(' ');
    const bool is_bare = begin != std::string::npos &&
                         std::string("[{\"'").find(assignment.value[begin]) == std::string::npos;
    if (!is_bare) throw;
    try {
      // JSON's escapes are TOML's.
      return parse(nlohmann::json(assignment.value.substr(begin)).dump());
    } catch (const nlohmann::json::exception&) {
      throw InputError("the value isn't UTF-8, must be TOML or plain text");
    }
  }
}

// The source of keys that the command line adds.
toml::source_region on_command_line(const Assignment& assignment) {
  const toml::source_position line = {static_cast<toml::source_index>(assignment.number + 1), 1};
  return {line, line, std::make_shared<const std::string>(assignment.origin)};
}

void assign(toml::table& table, std::span<const std::string> path, const Assignment& assignment);

bool is_method(const toml::node& element, const std::string& name) {
  const toml::table* method = element.as_table();
  return method != nullptr && (*method)["name"].value_or(std::string()) == name;
}

// The first part of a longer path names a method or a table that every method has.
void check_method_or_table(const toml::array& methods, const std::string& name) {
  std::vector<std::string> known = method_tables();
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  for (const toml::node& m : methods) {
    if (m.is_table()) known.push_back((*m.as_table())["name"].value_or(std::string()));
  }
  throw InputError(unknown_name("method or table of one", name, known));
}

// Every method, or the one that the path begins with.
void assign_methods(toml::array& methods, std::span<const std::string> path,
                    const Assignment& assignment) {
  const auto named = [&](const toml::node& m) { return is_method(m, path.front()); };
  const bool one = path.size() > 1 && std::any_of(methods.begin(), methods.end(), named);
  if (path.size() > 1 && !one) check_method_or_table(methods, path.front());
  for (toml::node& element : methods) {
    if (!element.is_table()) throw InputError("'method' must be a list of tables, [[method]]");
    if (one && !named(element)) continue;
    assign(*element.as_table(), one ? path.subspan(1) : path, assignment);
  }
}

void assign(toml::table& table, std::span<const std::string> path, const Assignment& assignment) {
  if (path.size() == 1) {
    toml::table parsed = parse_value(assignment);
    toml::node& value = *parsed.get("value");
    const toml::key key(path.front(), on_command_line(assignment));
    table.insert_or_assign(key, std::move(value));
    return;
  }
  toml::node* child = table.get(path.front());
  if (child == nullptr) {
    const toml::key key(path.front(), on_command_line(assignment));
    child = &table.insert(key, toml::table{}).first->second;
  }
  if (child->is_array() && path.front() == "method") {
    assign_methods(*child->as_array(), path.subspan(1), assignment);
  } else if (child->is_table()) {
    assign(*child->as_table(), path.subspan(1), assignment);
  } else {
    throw InputError("'" + path.front() + "' isn't a table, so nothing can be set in it");
  }
}

// The origin as a whole where toml++ has no record of it.
Place place_of(const toml::source_region& source, const std::string& origin) {
  const std::string where = source.path ? *source.path : origin;
  if (!source.begin) return {where};
  return {where, static_cast<int>(source.begin.line), static_cast<int>(source.begin.column)};
}

// Removes the keys that one that was set excludes.
void keep_only(toml::table& table, const std::string& set, std::span<const char* const> rivals) {
  if (std::ranges::find(rivals, set) == rivals.end()) return;
  for (const std::string rival : rivals) {
    if (rival != set) table.erase(rival);
  }
}

// But for those that the command line says.
void erase_of_file(toml::table* table, std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    const toml::node* const value = table == nullptr ? nullptr : table->get(key);
    if (value != nullptr && !place_of(value->source(), "").is_override()) table->erase(key);
  }
}

void remove_rival(toml::table& document, const Path& path) {
  toml::table* table = document[path.front()].as_table();
  if (path.size() < 2 || table == nullptr) return;
  if (path[0] == "simulator") keep_only(*table, path[1], kSourceKeys);
  if (path[0] != "target") return;
  if (path[1] != "truth" && table->contains("truth") &&
      (path[1] == "recording" || path[1] == "observation")) {
    // They are of the truth: how many rollouts to simulate isn't how many to use of a recording.
    // What the command line says is said of both.
    erase_of_file(table, {"seed", "num_rollouts", "inputs"});
    erase_of_file(document["simulator"].as_table(), {"dt", "num_steps", "initial_states"});
  }
  keep_only(*table, path[1], std::array{"recording", "truth", "observation"});
}

// What toml++ says of a text without quotes takes it for a number, or for true or false.
const char* advice_on(std::string_view description) {
  constexpr std::array taken_for = {"determine value type", "parsing floating-point",
                                    "parsing boolean", "decimal integer: expected"};
  const auto is_said = [&](const char* words) {
    return description.find(words) != description.npos;
  };
  if (std::ranges::any_of(taken_for, is_said)) {
    return "; texts stand in quotes, such as name = \"NPE\"";
  }
  const bool is_second = is_said("redefine existing table");
  return is_second ? "; a table stands once, each of several methods is [[method]]" : "";
}

toml::table parse_toml(std::string_view text, const std::string& origin) {
  try {
    require_few_dots(text, kMaxDotsOfFile);
    return toml::parse(text, std::string_view(origin));
  } catch (const InputError& error) {
    throw InputError(origin + ": " + error.what());
  } catch (const toml::parse_error& error) {
    throw InputError(place_of(error.source(), origin).str() + ": " +
                     std::string(error.description()) + advice_on(error.description()));
  }
}

nlohmann::json scalar(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* number = node.as_integer()) return number->get();
  if (const auto* number = node.as_floating_point()) return number->get();
  if (const auto* flag = node.as_boolean()) return flag->get();
  std::ostringstream date;
  node.visit([&](const auto& value) { date << value; });
  const std::string text = date.str();
  return nlohmann::json::binary({text.begin(), text.end()});
}

// Not by recursion, which tables in tables without end could take too deep.
nlohmann::json json_of(const toml::table& document, Reading& reading) {
  struct Item {
    const toml::node* node;
    nlohmann::json* json;
    std::string path;
  };
  nlohmann::json root;
  std::vector<Item> open = {{&document, &root, ""}};
  const auto place = [&](const toml::source_region& source) {
    return place_of(source, reading.origin());
  };
  while (!open.empty()) {
    const Item item = std::move(open.back());
    open.pop_back();
    if (const toml::table* table = item.node->as_table()) {
      *item.json = nlohmann::json::object();
      for (auto&& [key, node] : *table) {
        const std::string name(key.str());
        const std::string path = item.path.empty() ? name : item.path + "." + name;
        reading.add_source(path, {place(key.source()), place(node.source())});
        open.push_back({&node, &(*item.json)[name], path});
      }
    } else if (const toml::array* array = item.node->as_array()) {
      *item.json = std::vector<nlohmann::json>(array->size());
      for (std::size_t i = 0; i < array->size(); ++i) {
        const toml::node& node = (*array)[i];
        const std::string path = node.is_table() ? fmt::format("{}[{}]", item.path, i) : item.path;
        if (node.is_table()) reading.add_source(path, {{}, place(node.source())});
        open.push_back({&node, &(*item.json)[i], path});
      }
    } else {
      *item.json = scalar(*item.node);
    }
  }
  return root;
}

}  // namespace

nlohmann::json read_toml(std::string_view text, const std::vector<std::string>& overrides,
                         Reading& reading) {
  toml::table document = parse_toml(text, reading.origin());
  for (std::size_t i = 0; i < overrides.size(); ++i) {
    try {
      const Assignment assignment = parse_assignment(overrides[i], i);
      const Path path = parse_key(assignment.key);
      assign(document, path, assignment);
      remove_rival(document, path);
    } catch (const InputError& error) {
      reading.fail("", {kOverride + overrides[i]}, error.what());
    } catch (const toml::parse_error& error) {
      reading.fail("", {kOverride + overrides[i]}, error.what());
    }
  }
  return json_of(document, reading);
}

}  // namespace npdr::pipeline
