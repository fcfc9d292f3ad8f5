"""The studies of Otani and Bouyarmane 2017: a box and a door, from one demonstration each."""
