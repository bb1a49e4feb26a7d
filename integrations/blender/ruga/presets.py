"""Presets of skin, as `ruga help presets` lists them."""

# Name, and what is shown of it. A cross-check compares the names with the program's.
PRESETS: tuple[tuple[str, str], ...] = (
    ("forehead-furrow", "Horizontal furrows of the forehead: 10 mm at 4.5 %"),
    ("cheek", "Cheek and nasolabial folds: 8 mm at 5.4 %"),
    ("neck", "Folds of the neck: 12 mm at 4.2 %"),
    ("crows-feet", "Crow's feet beside the eye: 2.9 mm at 4.7 %"),
    ("knuckle", "Knuckles and back of the hand: 4.7 mm at 5.1 %"),
    ("eyelid", "Upper eyelid: 1.4 mm at 4.6 %"),
    ("fine-lines", "Fine lines, for painted regions only: 0.8 mm at 3.8 %"),
    ("face2-dermis", "Two-layer face, lower layer: 10 mm at 9.7 %"),
    ("face2-epidermis", "Two-layer face, upper layer: 0.8 mm at 4.0 %"),
    ("reference-dermis", "Dermis on fat, Li 2014: 11.3 mm at 13 %"),
    ("reference-epidermis", "Epidermis on dermis, Li 2014: 2.5 mm at 2.0 %"),
)
