"""Dariush 2009: online transfer of human motion; its methods on our clips."""
