// Pieces of HTML, told apart from texts by their type: a text that gets into a page is escaped on
// the way, so that no name in a user's file can become markup.
#pragma once

#include <fmt/format.h>

#include <concepts>
#include <string>
#include <string_view>

namespace axisfit {

/// The text with &, <, >, " and ' as entities, for elements and for quoted attributes.
std::string escaped(std::string_view text);

/// Markup, well-formed in itself.
class Html {
 public:
  Html() = default;
  Html& operator+=(const Html& other) {
    text_ += other.text_;
    return *this;
  }
  friend Html operator+(Html a, const Html& b) { return a += b; }
  bool empty() const { return text_.empty(); }
  const std::string& text() const { return text_; }

  /// From what is markup already, such as a style sheet.
  static Html raw(std::string_view markup) {
    Html html;
    html.text_ = markup;
    return html;
  }

 private:
  std::string text_;
};

namespace detail {
inline const std::string& in_html(const Html& html) { return html.text(); }
inline std::string in_html(std::string_view text) { return escaped(text); }
template <class Number>
requires std::integral<Number> || std::floating_point<Number> Number in_html(Number number) {
  return number;
}
}  // namespace detail

/// As fmt::format. The format is markup; values are texts, which are escaped, numbers, or Html.
template <class... Values>
Html html(fmt::string_view format, const Values&... values) {
  return Html::raw(fmt::format(fmt::runtime(format), detail::in_html(values)...));
}

/// What `piece` makes of each value, one after the other.
template <class List, class Piece>
Html each(const List& list, Piece&& piece) {
  Html all;
  for (const auto& value : list) all += piece(value);
  return all;
}

}  // namespace axisfit
