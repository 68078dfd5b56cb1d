#include "init/columns/answers.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace axisfit {
namespace {

template <class Read>
std::string refusal(Read read, const char* text) {
  try {
    read(text);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "none";
}

TEST(ReadAnswer, SaysWhatIsWrong) {
  const auto problem = [](const char* text) { return refusal(read_answer, text); };
  const std::string how =
      "; write SIGNAL=COLUMN:UNIT, such as position=3:mm, position=\"Geber [Ink]:um/8\" or "
      "force=Torque:N*0.2";
  EXPECT_EQ(problem("position="), "--column position=: the signal or the column is missing" + how);
  EXPECT_EQ(problem("position=:mm"), "--column position=:mm: the column is missing" + how);
  EXPECT_EQ(problem("positon=x:mm").find("--column positon=x:mm: there is no signal 'positon'"),
            0u);
  EXPECT_EQ(problem("force=x:N*0"),
            "--column force=x:N*0: the factor must be a number other than zero" + how);
  EXPECT_NE(problem("force=x:mm").find("--column force=x:mm: "), std::string::npos);
  EXPECT_EQ(problem("velocity=a: b:mm/s"), "none");
}

TEST(ReadAnswer, TakesEverySignalOfAJob) {
  const ColumnAnswer reference = read_answer("position_reference=q_des:rad");
  EXPECT_EQ(reference.kind, Kind::position);
  EXPECT_TRUE(reference.is_setpoint);
  EXPECT_EQ(read_answer("torque=tau:Nm").kind, Kind::force);
  EXPECT_EQ(stored_unit(Kind::force, read_answer("torque=tau:Nm").unit)->joint, Joint::revolute);
  EXPECT_EQ(read_answer("load_position=scale:um/5").kind, Kind::load_position);
  EXPECT_DOUBLE_EQ(read_answer("load_position=scale:um/5").factor, 0.2);
  EXPECT_EQ(read_answer("supply=Vbat:V").kind, Kind::supply);
  EXPECT_TRUE(read_answer("duty=pwm:1/255").is_duty);
  EXPECT_DOUBLE_EQ(read_answer("duty=pwm:1/255").factor, 1.0 / 255.0);
  for (const std::string_view signal : answerable_signals())
    EXPECT_EQ(read_answer(std::string(signal) + "=7").column, "7") << signal;
}

TEST(ReadAnswer, NeedsNoUnit) {
  const ColumnAnswer answer = read_answer("position=z_act/mm");
  EXPECT_EQ(answer.column, "z_act/mm");
  EXPECT_TRUE(answer.unit.empty());
}

TEST(ReadRate, IsAFrequency) {
  for (const auto& [text, hertz] : {std::pair("1 kHz", 1e3), {"500Hz", 500.0}, {"62.5", 62.5}})
    EXPECT_DOUBLE_EQ(read_rate(text), hertz) << text;
  for (const char* text : {"", "kHz", "1 ms", "-5 Hz", "0 Hz", "1 rpm", "1 kHz x"})
    EXPECT_EQ(refusal(read_rate, text).find(std::string("--rate ") + text + ": write how many"), 0u)
        << text;
}

}  // namespace
}  // namespace axisfit
