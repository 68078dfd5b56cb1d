"""Pictures of a result by matplotlib, where it is installed."""


class Plots:
    """result.plot.signals(), .residual(), .friction_map(), .force_over_position(), .parameters()."""

    def __init__(self, result):
        self._result = result

    @staticmethod
    def _axes(axes):
        if axes is not None:
            return axes
        try:
            from matplotlib import pyplot
        except ImportError as missing:
            raise ImportError("pictures need matplotlib: install python3-matplotlib") from missing
        return pyplot.subplots()[1]

    def _column(self, ending, recording):
        residuals = self._result.residuals
        names = [name for name in residuals if name.endswith(ending)]
        of = residuals["recording"] == recording
        return residuals, names, of

    def _over(self, variable, colour, recording, axes):
        """The missing force (or torque) over the arm's (or joint's) position or velocity."""
        residuals = self._result.residuals

        def column(*beginnings):
            return next((name for name in residuals if name.startswith(beginnings)), None)
        force = column("missing_")
        if force is None:
            raise ValueError("this result has no missing force: nothing that the fit could track was recorded")
        along, coloured = (column(f"arm_{what}", f"joint_{what}") for what in (variable, colour))
        of = residuals["recording"] == recording
        axes = self._axes(axes)
        shown = axes.scatter(residuals[along][of], residuals[force][of], s=2, c=residuals[coloured][of])
        axes.set_xlabel(along)
        axes.set_ylabel(force)
        axes.figure.colorbar(shown, ax=axes, label=coloured)
        return axes

    def signals(self, recording=1, axes=None):
        """Measured and simulated signals of a recording (its number, from 1) over time."""
        residuals, names, of = self._column("_measured", recording)
        axes = self._axes(axes)
        for name in names:
            signal = name.removesuffix("_measured")
            line, = axes.plot(residuals["time_s"][of], residuals[name][of], label=f"{signal}, measured")
            axes.plot(residuals["time_s"][of], residuals[signal + "_simulated"][of], "--", color=line.get_color(),
                      label=f"{signal}, simulated")
        axes.set_xlabel("time_s")
        axes.legend()
        return axes

    def residual(self, recording=1, axes=None):
        """Measured less simulated, over time."""
        residuals, names, of = self._column("_residual", recording)
        axes = self._axes(axes)
        for name in names:
            axes.plot(residuals["time_s"][of], residuals[name][of], label=name)
        axes.set_xlabel("time_s")
        axes.legend()
        return axes

    def friction_map(self, recording=1, axes=None):
        """The missing force over the velocity, coloured by the position."""
        return self._over("velocity", "position", recording, axes)

    def force_over_position(self, recording=1, axes=None):
        """The missing force over the position."""
        return self._over("position", "velocity", recording, axes)

    def parameters(self, axes=None):
        """Estimates with their 95 % intervals, each per its value."""
        axes = self._axes(axes)
        rows = [r for r in self._result.json["parameters"] if r["confidence_interval"] and r["value"]]
        for place, row in enumerate(rows):
            low, high = (end / row["value"] for end in row["confidence_interval"])
            axes.plot([low, high], [place, place], marker="|")
        axes.set_yticks(range(len(rows)), [row["name"] for row in rows])
        axes.set_xlabel("95 % interval / estimate")
        return axes
