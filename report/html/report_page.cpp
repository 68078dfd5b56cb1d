#include "report/html/report_page.h"

#include <ceres/version.h>

#include <algorithm>
#include <cmath>

#include "base/plain_text.h"
#include "base/rounding.h"
#include "base/text_table.h"
#include "base/version.h"
#include "report/html/assets/assets.h"
#include "report/html/report_charts.h"
#include "report/text/names.h"
#include "report/text/report_text.h"
#include "report/text/words.h"

namespace axisfit {
namespace {

std::string number(double x) { return fmt::format("{:.4g}", x); }

Html section(const char* id, const char* title, const Html& content) {
  if (content.empty()) return {};
  return html(R"(<section id="{0}" aria-labelledby="{0}-title"><h2 id="{0}-title">{1}</h2>{2})"
              "</section>",
              id, title, content);
}

Html paragraph_of(const std::string& text) {
  return text.empty() ? Html() : html("<p>{}</p>", text);
}

Html figures(const Html& content) {
  return content.empty() ? Html() : html(R"(<div class="figures">{}</div>)", content);
}

/// A table: names of the columns, and rows that are ready. Columns of which the name begins with
/// '#' hold numbers.
Html table(const std::vector<std::string>& columns, const Html& rows) {
  return html(
      R"(<div class="scroll" tabindex="0"><table><thead><tr>{}</tr></thead><tbody>{}</tbody></table></div>)",
      each(columns,
           [](const std::string& c) {
             return c.starts_with('#')
                        ? html(R"(<th scope="col" class="number">{}</th>)", c.substr(1))
                        : html(R"(<th scope="col">{}</th>)", c);
           }),
      rows);
}

Html cell(const std::string& text) { return html("<td>{}</td>", text); }
Html cell(const Html& content) { return html("<td>{}</td>", content); }
Html number_cell(const std::string& text) { return html(R"(<td class="number">{}</td>)", text); }
Html head_cell(const std::string& text) { return html(R"(<th scope="row">{}</th>)", text); }
Html row(const Html& cells) { return html("<tr>{}</tr>", cells); }

class Page {
 public:
  Page(const RunResult& run_result, const Provenance& run)
      : run_result_(run_result),
        run_(run),
        job_(run_result.job()),
        fit_(run_result.fit()),
        charts_(run_result) {
    // What was typed may be any bytes; a page is UTF-8.
    for (std::string* typed : {&run_.command, &run_.job_file, &run_.axis_file})
      *typed = sanitized(*typed);
  }

  std::string text() {
    Html main = section("verdict", "Verdict", verdict());
    main += section("recordings", "Measured and simulated", recordings());
    main += section("parameters", "Parameters", parameters());
    main += section("residual", "Residual", residual());
    main += section("loop", "Effect selection", selection());
    main += section("convergence", "Convergence", convergence());
    main += section("repeat", "Reproduce this run", repeat());
    const ReportAssets& assets = report_assets();
    std::string data = charts_.data().dump();
    for (std::size_t at = 0; (at = data.find('<', at)) != std::string::npos;)
      data.replace(at, 1, "\\u003c");
    const Html script =
        html(R"(<script type="application/json" id="charts">{}</script><script>{}</script>)",
             Html::raw(data), Html::raw(assets.script));
    const auto link = [&](const char* id, const char* name) {
      return main.text().find(fmt::format("<section id=\"{}\"", id)) == std::string::npos
                 ? Html()
                 : html(R"(<a href="#{}">{}</a>)", id, name);
    };
    return html(R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{0}</title>
<meta name="generator" content="axisfit {4}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data: blob:">
<style>{1}</style></head>
<body><a class="skip" href="#main">Skip to content</a>
<header><h1>{0}</h1><nav aria-label="Sections">{2}</nav></header>
<main id="main">{3}</main>
<footer>axisfit {4}</footer>{5}
</body></html>
)",
                title(), Html::raw(assets.css),
                link("verdict", "Verdict") + link("recordings", "Recordings") +
                    link("parameters", "Parameters") + link("residual", "Residual") +
                    link("loop", "Effects") + link("convergence", "Convergence") +
                    link("repeat", "Reproduce"),
                main, version(), script)
        .text();
  }

 private:
  std::string title() const {
    const std::string& axis = run_result_.baseline.axis;
    return axis.empty() ? "Fit of " + run_.job_file : "Fit of " + axis;
  }

  const char* verdict_class() const {
    if (!run_result_.grade.is_usable()) return "bad";
    return run_result_.grade.grade == Grade::explained ? "good" : "warn";
  }

  static Html fact(const std::string& name, const Html& value) {
    return html("<div><dt>{}</dt><dd>{}</dd></div>", name, value);
  }

  Html verdict() {
    Html summary = paragraph_of(overall_verdict(run_result_));
    if (!run_result_.selection && run_result_.diagnosis)
      summary += paragraph_of(residual_verdict(run_result_));
    Html all = html(R"(<div class="verdict {}">{}</div>)", verdict_class(), summary);
    for (const Discrimination& s : run_result_.discriminations)
      all += paragraph_of(discrimination_text(s, job_.vocabulary()));
    if (run_result_.interrupted) {
      all += paragraph_of(fmt::format("Stopped{} before everything requested was finished.",
                                      stop_reason(run_result_)));
      all += paragraph_of(stopped_errors_text(run_result_));
    }
    const auto determined = std::ranges::count_if(
        fit_.parameters, [](const ParameterResult& p) { return p.uncertainty.determined; });
    const bool closed = run_result_.selection && run_result_.selection->models.size() > 1;
    Html facts =
        fact("Reduced chi-square",
             closed ? html("{} <span class=\"arrow\">to</span> {}",
                           number(run_result_.selection->models.front().fit.reduced_chi_square),
                           number(fit_.reduced_chi_square))
                    : html("{}", number(fit_.reduced_chi_square))) +
        fact("Parameters determined", html("{} of {}", determined, fit_.parameters.size()));
    if (closed) {
      std::string added;
      for (const FittedModel& model : run_result_.selection->models)
        if (!model.added.empty()) added += (added.empty() ? "" : ", ") + model.added;
      facts += fact("Added", html("{}", added));
    }
    all += html(R"(<dl class="numbers">{}</dl>)", facts);
    return all + charts_.overview() + errors();
  }

  /// Of every signal, by the declared model and by the last.
  Html errors() {
    if (run_result_.selection) return selection_errors();
    Html rows;
    for (std::size_t r = 0; r < job_.recordings.size(); ++r)
      for (const SignalError& e : fit_.recordings[r].signals) {
        const bool finished = fit_.recordings[r].free_running.finished;
        const auto or_dash = [&](double value) { return finished ? number(value) : "-"; };
        rows += row(head_cell(job_.recordings[r].name) + cell(role_name(job_.recordings[r], e)) +
                    cell(std::string(info(e.signal, job_.vocabulary()).name)) +
                    number_cell(or_dash(e.rmse)) +
                    cell(std::string(info(e.signal, job_.vocabulary()).unit)) +
                    number_cell(finished ? fmt::format("{:.3g} %", e.nrmse_percent) : "-") +
                    number_cell(number(e.sigma)) + number_cell(or_dash(e.reduced_chi_square)) +
                    number_cell(e.prediction_rmse ? number(*e.prediction_rmse) : ""));
      }
    return html("<h3>Errors of the free-running simulation</h3>{}",
                table({"Recording", "Role", "Signal", "#rmse", "Unit", "#of range", "#noise",
                       "#reduced chi-square", "#prediction rmse"},
                      rows));
  }

  Html selection_errors() {
    Html rows;
    for (const SignalScore& head : run_result_.scores.front().signals) {
      const Recording& recording = job_.recordings[head.recording];
      const Measurement& m = recording.measurements[head.measurement];
      for (std::size_t i = 0; i < run_result_.selection->models.size(); ++i) {
        const SignalScore* score = find_series(run_result_.scores[i].signals, head);
        if (score == nullptr || !score->as_fitted()) continue;
        const SignalErrors& e = *score->as_fitted();
        rows += row(head_cell(recording.name) + cell(role_name(recording, head.fitted)) +
                    cell(std::string(info(m.signal, job_.vocabulary()).name)) +
                    cell(i == 0 ? "baseline" : "+ " + run_result_.selection->models[i].added) +
                    number_cell(number(e.rmse)) +
                    cell(std::string(info(m.signal, job_.vocabulary()).unit)) +
                    number_cell(fmt::format("{:.3g} %", e.nrmse_percent)) +
                    number_cell(number(e.reduced_chi_square)));
      }
    }
    return html("<h3>Errors before and after</h3>{}",
                table({"Recording", "Role", "Signal", "Model", "#rmse", "Unit", "#of range",
                       "#reduced chi-square"},
                      rows));
  }

  Html recordings() {
    Html all;
    for (std::size_t r = 0; r < job_.recordings.size(); ++r) {
      const Recording& recording = job_.recordings[r];
      all += html("<h3>{} <small>{}, {}, {} samples, {} s to {} s, {} events</small></h3>",
                  recording.name, role_name(recording, true), recording.file,
                  recording.times.size(), number(recording.times.front()),
                  number(recording.times.back()), fit_.recordings[r].free_running.events);
      for (const std::string& warning :
           warnings_for(run_result_.baseline, recording, run_result_.checks[r]))
        all += html("<p>! {}</p>", warning);
      all += charts_.traces(r);
    }
    return all;
  }

  /// The interval and the initial value between the bounds, on the parameter's scale.
  Html interval_bar(std::size_t i) const {
    const FreeParameter& free = as_specified(run_result_, i);
    const ParameterResult& p = fit_.parameters[i];
    const ParameterSpace space(std::span(&free, 1));
    const auto on_scale = [&](double v) { return space.internal(0, v); };
    const double low = on_scale(free.lower), high = on_scale(free.upper);
    constexpr double kFrom = 4.0, kTo = 156.0;
    const auto place = [&](double v) {
      return kFrom + (kTo - kFrom) * std::clamp((on_scale(v) - low) / (high - low), 0.0, 1.0);
    };
    Html drawing = html(R"(<line class="bound" x1="{}" x2="{}" y1="9" y2="9"/>)", kFrom, kTo);
    if (p.uncertainty.has_interval())
      drawing += html(R"(<line class="range" x1="{:.1f}" x2="{:.1f}" y1="9" y2="9"/>)",
                      place(p.uncertainty.lower), place(p.uncertainty.upper));
    drawing += html(R"(<line class="initial" x1="{0:.1f}" x2="{0:.1f}" y1="3" y2="15"/>)"
                    R"(<circle class="estimate" cx="{1:.1f}" cy="9" r="3"/>)",
                    place(free.initial), place(p.value));
    return html(R"(<svg class="interval" viewBox="0 0 160 18" role="img" aria-label="{}">{}</svg>)",
                fmt::format("bounds {} and {}, initial value {}", number(free.lower),
                            number(free.upper), number(free.initial)),
                drawing);
  }

  Html badge(const ParameterResult& p) const {
    const std::string_view unit = quantity_of(job_, p.id).unit;
    const ParameterUncertainty& u = p.uncertainty;
    const auto kind = [&] {
      switch (u.verdict()) {
        case ParameterVerdict::at_bound:
          return "bound";
        case ParameterVerdict::at_zero:
        case ParameterVerdict::not_determined:
        case ParameterVerdict::error_not_known:
        case ParameterVerdict::of_wrong_model:
          return "open";
        case ParameterVerdict::weakly_determined:
          return "weak";
        case ParameterVerdict::determined:
          break;
      }
      return "determined";
    };
    Html all =
        html(R"(<span class="badge {}">{}</span>)", kind(), std::string(verdict_name(u.verdict())));
    if (!p.rests_on.empty()) all += html(" <small>{}</small>", guesses_text(job_, p.rests_on));
    for (const std::string& move : moves_text(p, unit)) all += html(" <small>{}</small>", move);
    if (p.other_hold) all += html(" <small>{}</small>", hold_shift_text(job_, *p.other_hold, unit));
    return all;
  }

  Html parameters() {
    Html rows;
    for (std::size_t i = 0; i < fit_.parameters.size(); ++i) {
      const ParameterResult& p = fit_.parameters[i];
      const ParameterUncertainty& u = p.uncertainty;
      const Quantity& quantity = quantity_of(job_, p.id);
      const double error = u.determined ? u.standard_error : 0.0;
      rows += row(html(R"(<th scope="row">{} <small>{}</small></th>)", name_of(job_, p.id),
                       std::string(quantity.meaning)) +
                  number_cell(u.determined || u.at_bound ? with_digits_of(p.value, error)
                                                         : fmt::format("~{:.1g}", p.value)) +
                  number_cell(u.determined ? fmt::format("{:.2g}", error) : "-") +
                  number_cell(u.has_interval() ? with_digits_of(u.lower, error) + " to " +
                                                     with_digits_of(u.upper, error)
                                               : "-") +
                  html(R"(<td class="unit">{}</td>)", std::string(quantity.unit)) +
                  number_cell(number(as_specified(run_result_, i).initial)) +
                  cell(interval_bar(i)) + cell(badge(p)));
    }
    Html all = table({"Parameter", "#value", "#standard error", "#95 % interval", "Unit",
                      "#initial", "Within its bounds", "Verdict"},
                     rows) +
               paragraph_of(uncertainty_text(job_, fit_) + second_opinion_text(run_result_)) +
               correlation();
    if (run_result_.horizon) all += html("<pre>{}</pre>", horizon_text(run_result_));
    if (run_result_.scatter) all += html("<pre>{}</pre>", scatter_text(run_result_));
    if (!run_result_.profiles.empty())
      all += html("<h3>Likelihood profiles</h3>{}",
                  figures(each(run_result_.profiles,
                               [&](const Profile& p) { return charts_.profile(p); })));
    if (run_result_.options.predict)
      all += html("<h3>Prediction</h3><pre>{}</pre>{}", prediction_text(run_result_),
                  figures(each(run_result_.predictions, [&](const RecordingPrediction& p) {
                    return charts_.prediction(p);
                  })));
    if (run_result_.options.compare)
      all += html("<h3>Models compared</h3><pre>{}</pre>", comparison_text(run_result_));
    if (run_result_.options.suggest_experiment)
      all += html("<h3>Next experiment</h3><pre>{}</pre>", suggestion_text(run_result_));
    return all;
  }

  Html correlation() const {
    const auto n = fit_.correlation.rows();
    if (n < 2) return {};
    Html head = Html::raw("<td></td>"), rows;
    for (const ParameterResult& p : fit_.parameters)
      head += html(R"(<th scope="col">{}</th>)", name_of(job_, p.id));
    for (Eigen::Index i = 0; i < n; ++i) {
      Html cells = head_cell(name_of(job_, job_.free[static_cast<std::size_t>(i)]));
      for (Eigen::Index k = 0; k < n; ++k) {
        const double c = fit_.correlation(i, k);
        cells += std::isfinite(c) ? html(R"(<td style="--r:{:.3f}">{:.2f}</td>)", c, c)
                                  : Html::raw("<td>-</td>");
      }
      rows += row(cells);
    }
    return html(
        R"(<h3>Correlation of the estimates</h3><div class="scroll" tabindex="0"><table class="heat"><thead><tr>{}</tr></thead><tbody>{}</tbody></table></div>)",
        head, rows);
  }

  Html residual() {
    if (!run_result_.diagnosis) return {};
    const Diagnosis& diagnosis = *run_result_.diagnosis;
    Html all = run_result_.selection ? Html() : paragraph_of(residual_verdict(run_result_));
    all += tests(diagnosis);
    if (const std::string faults = instruments_text(job_, diagnosis); !faults.empty())
      all += html("<h3>Instruments</h3>{}", paragraph_of(faults));
    Html forces;
    for (std::size_t r = 0; r < job_.recordings.size(); ++r)
      if (const Html force = charts_.missing_force(r); !force.empty())
        forces += html("<h4>{}</h4>{}", job_.recordings[r].name, figures(force));
    if (!forces.empty())
      all += html("<h3>{}</h3>{}",
                  std::string(words_on(job_.vocabulary(), "Missing force on the arm")), forces);
    const auto worst =
        std::ranges::max_element(diagnosis.tests, {}, &SeriesTest::reduced_chi_square);
    for (auto test = diagnosis.tests.begin(); test != diagnosis.tests.end(); ++test)
      all += html(R"(<details{}><summary>{}</summary>{}</details>)",
                  Html::raw(test == worst ? " open" : ""), title_of(*test),
                  figures(charts_.views(*test)));
    return all;
  }

  std::string title_of(const SeriesTest& test) const {
    const Recording& recording = job_.recordings[test.series.recording];
    return fmt::format(
        "{} of {} ({})",
        info(recording.measurements[test.series.measurement].signal, job_.vocabulary()).name,
        recording.name, role_name(recording, test.series.fitted));
  }

  Html tests(const Diagnosis& diagnosis) const {
    Html rows = each(diagnosis.tests, [&](const SeriesTest& test) {
      std::string on;
      for (const Dependence& d : test.dependences)
        on += fmt::format("{}{} {}", on.empty() ? "" : ", ", d.on, percent(100.0 * d.fraction));
      return row(head_cell(title_of(test)) + number_cell(number(test.reduced_chi_square)) +
                 number_cell(test.explained ? "noise only"
                                            : fmt::format("{:.3g} %", test.unexplained_percent)) +
                 cell(on.empty() ? "nothing" : on));
    });
    Html all = table({"Series", "#reduced chi-square", "#unexplained", "Depends on"}, rows);
    if (run_result_.selection || run_result_.suspects.empty()) return all;
    rows = each(run_result_.suspects, [](const Scored& s) {
      return row(head_cell(s.hypothesis->name) + cell(s.hypothesis->meaning) +
                 cell(s.hypothesis->acts_on) + number_cell(percent(100.0 * s.fraction)));
    });
    return all + html("<h3>Suspected effects</h3>{}",
                      table({"Effect", "Meaning", "Acts on", "#explains"}, rows));
  }

  Html selection() {
    if (!run_result_.selection) return {};
    const EffectSelection& selection = *run_result_.selection;
    Html rounds;
    int last = 0;
    for (const Outcome& t : selection.effects) last = std::max(last, t.round);
    for (int round = 1; round <= last; ++round) {
      std::vector<const Outcome*> trials;
      for (const Outcome& t : selection.effects)
        if (t.round == round) trials.push_back(&t);
      if (trials.empty()) continue;
      std::ranges::stable_sort(trials, std::greater{}, [](const Outcome* t) { return t->score; });
      rounds +=
          html(R"(<li class="round"><h3>Round {}</h3>{}{}</li>)", round,
               table({"Effect", "#score", "Decision", "Reason", "#validation error", "#p-value"},
                     each(trials, [&](const Outcome* t) { return trial(*t); })),
               after_round(trials));
    }
    Html all = paragraph_of(verdict_text(selection));
    if (const std::string judges = judges_text(run_result_); !judges.empty())
      all += paragraph_of(judges);
    return all + html(R"(<ol class="rounds">{}</ol>)", rounds);
  }

  Html trial(const Outcome& t) const {
    const char* decision = decision_name(t.decision());
    const bool judged = t.improvement.comparable;
    return row(
        html(R"(<th scope="row">{} <small>{}</small></th>)", t.hypothesis.name,
             t.hypothesis.meaning) +
        number_cell(number(t.score)) +
        cell(html(R"(<span class="badge {0}">{0}</span>)", decision)) + cell(reason_text(job_, t)) +
        number_cell(judged ? fmt::format("{:+.3g} %", -t.improvement.validate_percent) : "-") +
        number_cell(judged ? fmt::format("{:.1g}", t.improvement.p_value) : "-"));
  }

  /// What became of the error when the round's effect was added.
  Html after_round(const std::vector<const Outcome*>& trials) const {
    const auto& models = run_result_.selection->models;
    for (std::size_t i = 1; i < models.size(); ++i)
      for (const Outcome* t : trials)
        if (t->hypothesis.name == models[i].added)
          return html("<p>With {}: reduced chi-square {} instead of {}.</p>", models[i].added,
                      number(models[i].fit.reduced_chi_square),
                      number(models[i - 1].fit.reduced_chi_square));
    return {};
  }

  Html convergence() {
    Html all = figures(charts_.convergence());
    const std::vector<Minimum> minima = distinct_minima(run_result_.first.starts);
    if (run_result_.first.starts.size() < 2 || minima.empty()) return all;
    std::vector<std::string> columns{"#reduced cost", "#starts"};
    for (std::size_t i = 0; i < minima.front().values.size(); ++i)
      columns.push_back("#" + name_of(run_result_.baseline, run_result_.baseline.free[i]));
    const Html rows = each(minima, [](const Minimum& m) {
      return row(number_cell(number(m.reduced_cost)) + number_cell(fmt::format("{}", m.starts)) +
                 each(m.values, [](double v) { return number_cell(number(v)); }));
    });
    return all + html("<h3>Minima reached by {} starts</h3>{}", run_result_.first.starts.size(),
                      table(columns, rows));
  }

  Html repeat() const {
    const FitOptions& options = run_result_.baseline.options;
    const Html facts =
        fact("Command", html("<code>{}</code>", run_.command)) +
        fact("Job", html("{}", run_.job_file)) + fact("Axis", html("{}", run_.axis_file)) +
        fact("Seed", html("{}", options.seed)) +
        fact("Starts", html("{}", std::max(1, options.starts))) +
        fact("Time taken", html("{} s", number(run_result_.wall_time))) +
        fact("axisfit", html("{}", version())) +
        fact("Built with",
             html("Ceres {}, Eigen {}.{}.{}, GCC {}", CERES_VERSION_STRING, EIGEN_WORLD_VERSION,
                  EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION, __VERSION__));
    const auto source = [](const std::string& file, const std::string& text) {
      return html(R"(<details><summary>{}</summary><pre class="source">{}</pre></details>)", file,
                  text);
    };
    return html(R"(<dl class="facts">{}</dl>)", facts) + source(run_.job_file, run_.job_text) +
           source(run_.axis_file, run_.axis_text);
  }

  const RunResult& run_result_;
  Provenance run_;
  const Job& job_;
  const FitResult& fit_;
  ReportCharts charts_;
};

}  // namespace

std::string report_page(const RunResult& run_result, const Provenance& run) {
  return Page(run_result, run).text();
}

}  // namespace axisfit
