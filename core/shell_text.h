/// Text that a shell reads back as it was.
#pragma once

#include <string>
#include <vector>

namespace npdr {

/// `word` as a shell reads it back: quoted where it needs it.
std::string shell_word(const std::string& word);

/// "npdr run study.toml --set 'a=b c'": words quoted for a shell where they need it.
std::string shell_text(const std::vector<std::string>& words);

}  // namespace npdr
