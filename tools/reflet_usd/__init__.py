"""USD stages to glTF 2.0: conversion, validation, inspection and corpus reports."""

__version__ = "0.2.0"
