"""``matrix.html``: the matrix with what it stands for, and a card for each case, which reports of routes show, too."""
