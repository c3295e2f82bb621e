/// Tables that documents hold for code.
#pragma once

#include <map>
#include <string>

namespace npdr {

/// The blocks of a document between "<!-- KIND: NAME -->" and "<!-- end -->", by name.
inline std::map<std::string, std::string> document_tables(const std::string& text,
                                                          const std::string& kind) {
  const std::string begin = "<!-- " + kind + ": ", end = "<!-- end -->\n";
  std::map<std::string, std::string> tables;
  for (std::size_t at = text.find(begin); at != std::string::npos; at = text.find(begin, at + 1)) {
    const std::size_t name = at + begin.size(), body = text.find('\n', at) + 1;
    tables[text.substr(name, text.find(' ', name) - name)] =
        text.substr(body, text.find(end, body) - body);
  }
  return tables;
}

}  // namespace npdr
