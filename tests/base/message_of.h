// What a call refuses, for tests of messages.
#pragma once

#include <exception>
#include <string>

namespace axisfit {

/// The message of what a call throws; empty if nothing.
template <class Call>
std::string message_of(Call&& call) {
  try {
    call();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

}  // namespace axisfit
