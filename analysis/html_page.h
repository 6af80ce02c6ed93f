#pragma once

#include <string>
#include <string_view>

namespace pliant::internal {

/// Text as it may stand in an element or an attribute.
std::string Escaped(std::string_view text);

/// A page with the sheet of all pages, whose colours are variables, light or dark.
std::string HtmlPage(std::string_view title, std::string_view body);

}  // namespace pliant::internal
