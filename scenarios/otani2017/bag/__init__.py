"""A bag fetched from a table that a hand leans on, over one leg: the first scene of Otani 2017, IV."""
