#pragma once

#include <span>
#include <string>
#include <string_view>

namespace axisfit {

// Returns the candidate a user most likely meant by the unknown `name`, or an empty string when no
// candidate is close enough to be worth suggesting. Meant for "did you mean ...?" in messages.
//
// Close is measured in edits (insert, delete, replace a character, swap two neighbours) with
// ASCII case ignored: at most a third of the longer name, though never fewer than two, and no more
// than half of its characters. Among equally close candidates the one with the more similar case
// wins, then the first.
std::string closest_match(std::string_view name, std::span<const std::string> candidates);

}  // namespace axisfit
