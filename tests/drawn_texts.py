"""What a figure shows where: letters that are cut, that overlap, or that lie on a picture."""

import itertools

from matplotlib.legend import Legend
from matplotlib.text import Text

#: Bounding boxes of letters have room above and below them: overlaps up to this are none to the eye [mm].
TOUCH = 0.15


def drawn_texts(figure, monkeypatch):
    """Every text that is drawn, ticks outside of the view left out."""
    texts, draw = [], Text.draw
    with monkeypatch.context() as patch:
        patch.setattr(Text, "draw", lambda text, renderer: (texts.append(text), draw(text, renderer))[1])
        figure.canvas.draw()
        texts.clear()  # the layout's own drawing
        figure.canvas.draw()
    return [text for text in dict.fromkeys(texts) if text.get_visible() and text.get_text().strip()]


def faults(figure, monkeypatch):
    """What is wrong with a figure's letters, in words; none is []."""
    mm = figure.dpi / 25.4
    boxes = {text: text.get_window_extent().padded(-TOUCH * mm) for text in drawn_texts(figure, monkeypatch)}
    assert boxes
    sheet = figure.bbox
    axes = [ax for top in figure.axes for ax in (top, *top.child_axes) if ax.axison]
    legends = {text for legend in figure.findobj(Legend) for text in legend.get_texts()}
    within = legends | {text for ax in axes for text in ax.texts}
    wrong = [
        f"{text.get_text()!r} is cut"
        for text, box in boxes.items()
        if not (sheet.x0 <= box.x0 and box.x1 <= sheet.x1 and sheet.y0 <= box.y0 and box.y1 <= sheet.y1)
    ]
    wrong += [
        f"{a.get_text()!r} overlaps {b.get_text()!r}"
        for a, b in itertools.combinations(boxes, 2)
        if boxes[a].overlaps(boxes[b])
    ]
    return wrong + [
        f"{text.get_text()!r} lies on the picture"
        for text, box in boxes.items()
        for ax in axes
        if text not in within and box.overlaps(ax.get_window_extent().padded(-TOUCH * mm))
    ]
