#include "tests/architecture/include_rules.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <regex>
#include <string_view>

#include "core/error.h"
#include "core/text.h"

namespace npdr::architecture {
namespace {

namespace fs = std::filesystem;

/// A folder and the folders that it may include.
struct Direction {
  std::string folder;
  std::vector<std::string> may_include;
};

/// A library that only one folder may include.
struct Library {
  std::string name;
  std::regex headers;
  std::string folder;
};

const std::vector<Direction>& directions() {
  static const std::vector<Direction> all = {
      {"core", {"core"}},
      {"sim", {"core", "sim"}},
      {"inference", {"core", "inference"}},
      {"analysis", {"core", "analysis"}},
      {"pipeline", {"core", "sim", "inference", "analysis", "pipeline"}},
  };
  return all;
}

// The layers of pipeline: each may include itself and those before it, but stages and reports,
// which know nothing of each other.
const std::vector<std::string>& layers() {
  static const std::vector<std::string> all = {
      "process",     "store",    "config", "artefacts", "import", "sources", "plan", "features",
      "predictions", "findings", "stages", "report",    "run",    "cluster", "apps"};
  return all;
}

// The layers that know nothing of the science: of sim, inference and analysis.
constexpr std::size_t kNumPlainLayers = 2;

std::size_t position_of(const std::string& layer) {
  return static_cast<std::size_t>(std::ranges::find(layers(), layer) - layers().begin());
}

const std::vector<Library>& libraries() {
  static const std::vector<Library> all = {
      {"HDF5", std::regex("(.*/)?(hdf5\\w*|H5\\w*)\\.h(pp)?|highfive/.*"), "pipeline/store"},
      {"TOML", std::regex("toml\\+\\+/.*|(.*/)?toml\\.h(pp)?"), "pipeline/config"},
  };
  return all;
}

std::string top_folder(const fs::path& path) { return path.begin()->string(); }

// "store" of pipeline/store/h5.h; empty where the path isn't in a folder of pipeline.
std::string layer_of(const fs::path& path) {
  const auto begin = path.begin();
  const auto depth = std::distance(begin, path.end());
  return depth > 2 && *begin == "pipeline" ? std::next(begin)->string() : "";
}

bool lies_below(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first ==
         folder.end();
}

// The file as the compiler finds it: with quotes next to the file that includes it, else below the
// root. Empty for headers of the system and generated ones.
fs::path resolve(const fs::path& root, const fs::path& file, bool quoted, const std::string& text) {
  fs::path beside = (file.parent_path() / text).lexically_normal();
  if (quoted && fs::exists(root / beside)) return beside;
  fs::path below = fs::path(text).lexically_normal();
  return fs::exists(root / below) ? below : fs::path();
}

std::vector<fs::path> sources_below(const fs::path& root, const std::string& folder) {
  if (!fs::is_directory(root / folder)) {
    throw Error((root / folder).string() + ": no such folder of sources");
  }
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".h" || extension == ".cpp") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

void append_includes(const fs::path& root, const fs::path& file, std::vector<Include>& includes) {
  static const std::regex pattern(R"re(\s*#\s*include\s*(["<])([^">]+)[">].*)re");
  std::ifstream stream(root / file);
  if (!stream) throw Error((root / file).string() + ": can't be read");
  std::string line;
  std::smatch match;
  for (int number = 1; std::getline(stream, line); ++number) {
    if (!std::regex_match(line, match, pattern)) continue;
    const std::string text = match[2];
    includes.push_back({file, number, text, resolve(root, file, match[1] == "\"", text)});
  }
}

std::string location(const Include& include) {
  return include.file.generic_string() + ":" + std::to_string(include.line);
}

}  // namespace

std::vector<std::string> known_folders() {
  std::vector<std::string> folders;
  for (const Direction& direction : directions()) folders.push_back(direction.folder);
  return folders;
}

std::vector<std::string> known_layers() { return layers(); }

std::vector<Include> includes_below(const fs::path& root, const std::string& folder) {
  std::vector<Include> includes;
  for (const fs::path& file : sources_below(root, folder)) {
    append_includes(root, file.lexically_relative(root), includes);
  }
  return includes;
}

namespace {

// Rule that an include of a layer of pipeline breaks; empty: none.
std::string broken_order(const Include& include) {
  const std::string from = layer_of(include.file), to = layer_of(include.path);
  if (from.empty()) return "";
  const std::size_t position = position_of(from);
  if (position == layers().size()) return "pipeline has no layer " + from;
  if (top_folder(include.path) == "pipeline") {
    const bool is_sibling = from == "report" && to == "stages";
    if (!is_sibling && position_of(to) <= position) return "";
    return from + " may include only layers before it: " +
           join({layers().begin(), layers().begin() + static_cast<std::ptrdiff_t>(position)});
  }
  if (position >= kNumPlainLayers || top_folder(include.path) == "core") return "";
  return from + " may include only core and layers before it";
}

}  // namespace

std::vector<std::string> broken_rules(const Include& include) {
  std::vector<std::string> broken;
  const std::string target = include.path.empty() ? include.text : include.path.generic_string();
  const std::string start = location(include) + ": includes " + target + "; ";
  for (const Direction& from : directions()) {
    if (include.path.empty() || top_folder(include.file) != from.folder) continue;
    const auto& allowed = from.may_include;
    if (std::find(allowed.begin(), allowed.end(), top_folder(include.path)) != allowed.end())
      continue;
    broken.push_back(start + from.folder + " may include only: " + join(allowed));
  }
  if (const std::string rule = include.path.empty() ? "" : broken_order(include); !rule.empty()) {
    broken.push_back(start + rule);
  }
  for (const Library& library : libraries()) {
    if (!include.path.empty() || !std::regex_match(include.text, library.headers)) continue;
    if (lies_below(include.file, library.folder)) continue;
    broken.push_back(start + "only " + library.folder + " may include " + library.name);
  }
  return broken;
}

std::vector<std::string> broken_rules(const fs::path& root) {
  std::vector<std::string> broken;
  for (const std::string& folder : known_folders()) {
    for (const Include& include : includes_below(root, folder)) {
      for (std::string& message : broken_rules(include)) broken.push_back(std::move(message));
    }
  }
  return broken;
}

std::vector<std::string> late_own_headers(const fs::path& root) {
  std::vector<std::string> late;
  for (const std::string& folder : known_folders()) {
    std::map<fs::path, Include> first;  // of each file
    for (const Include& include : includes_below(root, folder)) {
      first.emplace(include.file, include);
    }
    for (const fs::path& file : sources_below(root, folder)) {
      const fs::path source = file.lexically_relative(root);
      const fs::path header = fs::path(source).replace_extension(".h");
      if (source.extension() != ".cpp" || !fs::exists(root / header)) continue;
      const auto found = first.find(source);
      if (found != first.end() && found->second.path == header) continue;
      late.push_back(source.generic_string() + ": include " + header.generic_string() + " first");
    }
  }
  return late;
}

}  // namespace npdr::architecture
