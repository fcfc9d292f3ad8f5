"""Ramos 2011: edit a dance by tasks, and lay it beside the paper's figures."""
