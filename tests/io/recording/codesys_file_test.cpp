#include "io/recording/codesys_file.h"

#include <cmath>

#include "tests/io/recording/kind_fixture.h"

namespace axisfit {
namespace {

using CodesysTest = KindTest;

/// As CODESYS saves it; of the configuration only what counts.
std::string trace(const std::string& micro_seconds, const std::string& variables) {
  return "<Trace>\r\n  <TraceConfiguration>\r\n    <Single Method=\"IArchivable\">\r\n"
         "      <Single Name=\"Record\"><Single Name=\"MicroSeconds\" Type=\"bool\">" +
         micro_seconds +
         "</Single></Single>\r\n    </Single>\r\n  </TraceConfiguration>\r\n"
         "  <TraceData Version=\"1.0.0.0\">\r\n    <TraceRecord>" +
         variables + "</TraceRecord>\r\n  </TraceData>\r\n</Trace>\r\n";
}

std::string variable(const std::string& name, const std::string& values, const std::string& times) {
  return "<TraceVariable VarName=\"" + name + "\" Type=\"System.Double\"><Values>" + values +
         "</Values><Timestamps>" + times + "</Timestamps></TraceVariable>";
}

std::string in_utf16(const std::string& text) {
  std::string wide = "\xFF\xFE";
  for (const char c : text) wide += {c, '\0'};
  return wide;
}

TEST_F(CodesysTest, ATraceHasTheTimesOfEveryVariable) {
  const std::string text =
      trace("True", variable("PLC_PRG.lrPos", "714.325,716.325,-1E-3", "18,48,78") +
                        variable("PLC_PRG.lrSpeed", "200, 201, 202", "18,48,78") +
                        variable("PLC_PRG.xOn", "False,True", "18,78"));
  for (const std::string& contents : {text, in_utf16(text)}) {
    const RecordingFile file = read(contents);
    EXPECT_EQ(column(file, "PLC_PRG.lrPos").values, (Values{714.325, 716.325, -1e-3}));
    EXPECT_EQ(column(file, "PLC_PRG.lrSpeed").values, (Values{200, 201, 202}));
    EXPECT_EQ(column(file, "PLC_PRG.xOn").values, (Values{0, 1}));
    // Equal times are one clock.
    EXPECT_EQ(file.columns().size(), 5u);
    EXPECT_EQ(clock(file, "PLC_PRG.lrSpeed").values, (Values{18, 48, 78}));
    EXPECT_EQ(clock(file, "PLC_PRG.xOn").name, "Time (PLC_PRG.xOn)");
    EXPECT_EQ(clock(file, "PLC_PRG.xOn").unit, "us");
  }
}

TEST_F(CodesysTest, TheConfigurationOfATraceSaysTheUnitOfItsTimes) {
  EXPECT_EQ(clock(read(trace("False", variable("a", "1,2", "0,1"))), "a").unit, "ms");
  const std::string bare = "<Trace><TraceData><TraceRecord>" + variable("a", "1,2", "0,1") +
                           "</TraceRecord></TraceData></Trace>";
  EXPECT_EQ(clock(read(bare), "a").unit, "");
}

TEST_F(CodesysTest, SaysWhatIsWrongWithAVariable) {
  const RecordingFile file =
      read(trace("True", variable("a", "1,2,3", "0,1") + variable("b", "1,Idle", "0,1") +
                             variable("c", "", "") + variable("a", "5", "0")));
  EXPECT_EQ(problem(file, "a"), "'a' in run.dat has 3 values but 2 times; save the trace again");
  EXPECT_EQ(problem(file, "b"), "'b' in run.dat has 'Idle' as sample 2, which is no finite number");
  EXPECT_EQ(column(file, "a(2)").values, Values{5});
}

TEST_F(CodesysTest, RefusesATraceWithoutSamplesOrThatIsDamaged) {
  EXPECT_EQ(error(trace("True", "")),
            "run.dat: is a trace of CODESYS without samples; record it, and save it again from the "
            "trace editor as .trace or .csv");
  EXPECT_EQ(
      error(trace("True", variable("a", "1,2", "0,now"))),
      "run.dat: the variable 'a' has the time 'now', which is no number; save the trace again");
  const std::string whole = trace("True", variable("a", "1,2", "0,1"));
  EXPECT_NE(error(whole.substr(0, whole.size() - 20)).find("breaks off or is damaged near byte"),
            std::string::npos);
}

std::string keys(const std::string& flags) {
  return "[key]; [value]\nIecTaskName; MainTask\nFlags; " + flags +
         "\n0.Variable; GVL.pos\n0.Class; 7\n0.Data; \n; 2; 25\r\n; 22; 25,5\r\n; 42; 26.5\r\n"
         "1.Variable; GVL.on\n1.Data; \n; 2; TRUE\r\n; 42; FALSE\r\n";
}

TEST_F(CodesysTest, TheCsvOfATraceHasASeriesForEveryVariable) {
  const RecordingFile file = read(keys("32"));
  EXPECT_EQ(column(file, "GVL.pos").values, (Values{25, 25.5, 26.5}));
  EXPECT_EQ(clock(file, "GVL.pos").values, (Values{2, 22, 42}));
  EXPECT_EQ(clock(file, "GVL.pos").unit, "us");
  EXPECT_EQ(column(file, "GVL.on").values, (Values{1, 0}));
  EXPECT_EQ(clock(file, "GVL.on").values, (Values{2, 42}));
}

TEST_F(CodesysTest, TheFlagsOfACsvSayTheUnitOfItsTimes) {
  // A condition of the record sets a flag, too.
  EXPECT_EQ(clock(read(keys("20")), "GVL.pos").unit, "ms");
  for (const char* flags : {"0", "48", "x"})
    EXPECT_EQ(clock(read(keys(flags)), "GVL.pos").unit, "") << flags;
}

TEST_F(CodesysTest, RefusesTheLineOfACsvThatIsNoSample) {
  EXPECT_EQ(error("[key]; [value]\n; 1; 2\n"),
            "run.dat:2: there is a sample before any variable; save the trace again");
  EXPECT_EQ(error("[key]; [value]\n0.Variable; a\n; x; 2\n"),
            "run.dat:3: is no sample of a time and a value; save the trace again");
}

TEST_F(CodesysTest, TheTextOfATraceIsATable) {
  std::string text =
      "CODESYS V3.5 SP20 Trace: Trace\nC:\\Trace\\Sample.project\n"
      "Timestamp(ms) PLC_PRG.lrPos PLC_PRG.lrSpeed\n";
  for (int i = 0; i < 20; ++i)
    text += std::to_string(30 * i) + " " + std::to_string(714.5 + 2 * i) + " 200\n";
  const RecordingFile file = read(text);
  ASSERT_EQ(file.columns().size(), 3u);
  EXPECT_EQ(file.columns()[0].name, "Timestamp(ms)");
  EXPECT_EQ(column(file, "PLC_PRG.lrPos").values[1], 716.5);
}

}  // namespace
}  // namespace axisfit
