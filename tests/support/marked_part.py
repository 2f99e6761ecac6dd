"""The part of a page between two marks, which a command writes anew."""
# SPDX-License-Identifier: BSD-3-Clause


def write(page, begin, end, text):
    before, _, rest = page.read_text().partition(begin + "\n")
    page.write_text(before + begin + "\n\n" + text + "\n\n" + end + rest.partition(end)[2])
