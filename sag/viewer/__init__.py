"""The viewer: motions in their scenes as one HTML file that needs nothing else, to be opened by any browser.

`page` makes the file of what it is given; `shown_window` gathers that from a data set and motions.
"""

from sag.viewer.page import page
from sag.viewer.shown import ShownMotion, ShownRow, ShownScene, ShownWindow
from sag.viewer.windows import shown_window

__all__ = ["ShownMotion", "ShownRow", "ShownScene", "ShownWindow", "page", "shown_window"]
