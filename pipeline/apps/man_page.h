/// The page of `npdr` for man(1).
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace npdr::pipeline {

/// All commands of `app` with their options and examples, in the language of man(7).
std::string man_page(CLI::App& app);

}  // namespace npdr::pipeline
