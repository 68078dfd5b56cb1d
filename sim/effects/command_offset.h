#pragma once

#include "sim/effects/slots.h"

namespace axisfit {

/// A voltage that the drive adds to its command: an amplifier's offset.
template <class T>
struct CommandOffset {
  static constexpr std::string_view name = "command_offset";
  static constexpr std::string_view meaning = "offset of the command";

  T U_0;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& visit) {
    visit(Quantity{"U_0", "V", "offset of the command", -1e3, 1e3}, self.U_0);
  }

  void add_to(Slots<T>& slots) const { slots.command_offset += U_0; }
};

}  // namespace axisfit
