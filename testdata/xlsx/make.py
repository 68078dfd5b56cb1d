#!/usr/bin/env python3
"""make.py: writes recording.xlsx, with openpyxl (Debian's python3-openpyxl), as a logger that
exports workbooks does: a sheet of notes that is empty, then one with a title, names, units, numbers,
dates, texts and gaps."""
import datetime
import pathlib

import openpyxl

book = openpyxl.Workbook()
book.active.title = "Notes"
sheet = book.create_sheet("Log & data")
sheet.append(["Axis 2, after service"])
sheet.append([])
sheet.append(["Clock", "Time", "Position", "Current", "State", "Slow"])
sheet.append([None, "ms", "mm", "A", None, "degC"])
begin = datetime.datetime(2026, 3, 16, 17, 4, 51)
for i in range(50):
    sheet.append(
        [
            begin + datetime.timedelta(milliseconds=10 * i),
            10 * i,
            0.125 * i,
            -1.5 if i % 2 else 2,
            "run" if i else "start",
            20.5 + i if i % 10 == 0 else None,
        ]
    )
book.save(pathlib.Path(__file__).with_name("recording.xlsx"))
